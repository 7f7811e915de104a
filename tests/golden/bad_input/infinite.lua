return rrt { step = math.huge }, scenes.cup()
