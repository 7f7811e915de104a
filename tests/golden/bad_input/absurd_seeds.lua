return experiment { problems = scenes.cup(), strategies = { rrt = rrt {} }, seeds = 1e12 }
