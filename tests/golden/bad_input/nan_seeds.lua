return experiment { problems = scenes.cup(), strategies = { rrt = rrt {} }, seeds = 0 / 0 }
