return rrt { step = -1 }, scenes.cup()
