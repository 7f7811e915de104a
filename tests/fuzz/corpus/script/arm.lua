local p = problem { name = "arm", world = world { bounds = {-4, -4, 4, 4}, disc {2, 2, 0.5} }, robot = robot.arm { links = {1, 1, 0.5}, width = 0.1 }, start = {0, 0, 0}, goal = {2, 1, 0.5} }
return pca { dimensions = 2 } >> rrt { step = 0.3 }, p
