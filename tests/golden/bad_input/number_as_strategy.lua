return experiment { problems = scenes.cup(), strategies = { rrt = 3 } }
