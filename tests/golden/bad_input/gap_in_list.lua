return experiment { problems = { scenes.cup(), nil, scenes.trap() }, strategies = { rrt = rrt {} } }
