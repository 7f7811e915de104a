return lazy() / 2 >> rrt {}, scenes.cup()
