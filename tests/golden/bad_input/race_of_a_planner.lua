return race { lazy(), rrt {} } >> rrt {}, scenes.cup()
