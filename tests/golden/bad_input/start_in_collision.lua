return rrt {}, scenes.cup { start = {6.7, 5, 0} }
