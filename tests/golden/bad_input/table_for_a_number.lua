return rrt { step = {} }, scenes.cup()
