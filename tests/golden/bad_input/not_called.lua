return skeleton >> rrt {}, scenes.cup()
