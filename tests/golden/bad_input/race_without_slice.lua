return race { lazy(), shrink(0.5), slice = 0 } >> rrt {}, scenes.cup()
