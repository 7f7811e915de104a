return skeleton { penetration = 2 } >> rrt {}, scenes.cup()
