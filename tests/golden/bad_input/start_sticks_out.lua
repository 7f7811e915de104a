return rrt {}, scenes.cup { start = {0.1, 5, 0} }
