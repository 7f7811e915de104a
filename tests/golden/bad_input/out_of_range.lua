return shrink(1.5) >> rrt {}, scenes.cup()
