local w = world { bounds = {0, 0, 10, 10}, box {4, 0, 5, 6}, disc {7, 7, 1}, polygon {{1, 5}, {3, 5}, {2, 7}}, box {8, 2, 9, 3, name = "crate"} }
local p = problem { name = "own", world = w, robot = robot.rectangle(0.6, 0.2), start = {1, 1, 0}, goal = {9, 9, 1.5}, weight = 0.3, resolution = 0.05 }
return experiment { problems = p, strategies = { a = rrt_connect { step = 0.5 }, b = skeleton { clearance = 0.1 } >> rrt {}, c = 0.5 * goal_bias(0.1) + 0.5 * bridge_test() >> prm { } }, seeds = 2, measure = tube { delta = 0.5 } }
