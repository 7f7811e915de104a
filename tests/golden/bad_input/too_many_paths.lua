return shrink { 0.5, paths = 100 } >> rrt {}, scenes.cup()
