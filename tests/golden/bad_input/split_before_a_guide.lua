return split { rrt {} } >> lazy() >> rrt {}, scenes.cup()
