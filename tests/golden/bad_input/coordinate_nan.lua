return rrt {}, scenes.cup { start = {1, 0 / 0, 0} }
