return experiment { problem = scenes.cup(), strategies = { rrt = rrt {} } }
