return experiment { problems = scenes.cup(), strategies = { rrt = rrt {}, prm = prm {} }, baseline = "rrt_connect" }
