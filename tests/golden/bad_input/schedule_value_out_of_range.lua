return schedule { shrink, scale = {0.3, 1.6} } >> rrt {}, scenes.cup()
