return blend { skeleton(), lazy(), floor = 0 } >> rrt {}, scenes.cup()
