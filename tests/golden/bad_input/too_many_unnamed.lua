return shrink(0.5, 0.6) >> rrt {}, scenes.cup()
