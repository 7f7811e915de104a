return experiment { problems = scenes.cup(), strategies = { rrt = rrt {} }, seeds = {1, -2} }
