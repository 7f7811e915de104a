return schedule { shrink, scal = {0.3, 0.6} } >> rrt {}, scenes.cup()
