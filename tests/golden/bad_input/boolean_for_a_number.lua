return shrink(true) >> rrt {}, scenes.cup()
