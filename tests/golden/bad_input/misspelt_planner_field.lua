return lazy { planer = prm {} } >> rrt {}, scenes.cup()
