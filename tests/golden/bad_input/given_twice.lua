return shrink { 0.5, scale = 0.6 } >> rrt {}, scenes.cup()
