return experiment { problems = {}, strategies = { rrt = rrt {} } }
