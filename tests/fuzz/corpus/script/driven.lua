local w = world { bounds = {0, 0, 10, 10}, box {4, 0, 5, 6} }
local p = problem { name = "car", world = w, robot = robot.rectangle(0.5, 0.25), start = {1, 1, 0}, goal = {9, 9, 0}, motion = motion.car { dt = 0.1, max_speed = 1, min_speed = -0.5, wheelbase = 0.25 }, goal_tolerance = 0.3 }
return skeleton() >> holonomic() >> kinodynamic_rrt { longest = 1, connect = 1 }, p
