return rrt {}, problem { name = "far", world = world { bounds = {10, 10}, polygon {{4, 4}, {1e308, 4}, {4, 6}} }, robot = robot.disc(0.3), start = {1, 1}, goal = {9, 9} }
