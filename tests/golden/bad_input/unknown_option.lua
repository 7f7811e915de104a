local a = rrt { step = 0.5 }
return rrt { stp = 0.5 }, scenes.cup()
