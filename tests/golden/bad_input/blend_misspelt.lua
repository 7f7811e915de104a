return blend { skeleton(), lazy(), flor = 0.1 } >> rrt {}, scenes.cup()
