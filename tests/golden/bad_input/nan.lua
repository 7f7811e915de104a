return rrt { step = 0 / 0 }, scenes.cup()
