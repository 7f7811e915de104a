return split { rrt {}, depth = 9 }, scenes.cup()
