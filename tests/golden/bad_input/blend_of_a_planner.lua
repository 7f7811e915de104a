return blend { skeleton(), rrt {} } >> rrt {}, scenes.cup()
