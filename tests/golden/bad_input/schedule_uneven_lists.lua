return schedule { shrink, scale = {0.3, 0.6}, evidence = {50, 60, 70} } >> rrt {}, scenes.cup()
