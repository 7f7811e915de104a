return schedule { shrink(0.3), lazy(), round = 2 } >> rrt {}, scenes.cup()
