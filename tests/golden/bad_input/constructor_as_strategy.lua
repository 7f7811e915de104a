return experiment { problems = scenes.cup(), strategies = { rrt = rrt } }
