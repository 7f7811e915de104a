return uniform { share = 0.5 } >> rrt {}, scenes.cup()
