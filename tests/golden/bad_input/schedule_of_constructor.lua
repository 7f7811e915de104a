return schedule { shrink } >> rrt {}, scenes.cup()
