return rrt { step = 0.5 } >> lazy() >> rrt {}, scenes.cup()
