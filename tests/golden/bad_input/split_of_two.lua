return split { rrt {}, prm {} }, scenes.cup()
