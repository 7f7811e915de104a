return schedule { shrink, lazy(), scale = {0.3, 0.6} } >> rrt {}, scenes.cup()
