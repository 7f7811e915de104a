return rrt {}, scenes.cup { start = {-1, 5, 0} }
