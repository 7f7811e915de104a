return experiment { problems = scenes.cup(), strategies = { rrt = rrt {} }, measure = false, cross = 2 }
