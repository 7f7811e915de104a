return shrink { 0.5, prm {} } >> rrt {}, scenes.cup()
