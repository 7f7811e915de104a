local w = world { bounds = {0, 0, 10, 10}, box {4, 4, 6, 6}, disc {8, 8, 1, name = "the pond"} }

local p = problem { world = w, robot = robot.disc(0.2), start = {1, 1}, goal = {8, 7} }
return rrt {}, p
