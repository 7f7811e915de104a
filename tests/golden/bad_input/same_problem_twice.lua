return experiment { problems = { scenes.cup(), scenes.cup() }, strategies = { rrt = rrt {} } }
