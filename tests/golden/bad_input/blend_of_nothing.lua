return blend { floor = 0.5 } >> rrt {}, scenes.cup()
