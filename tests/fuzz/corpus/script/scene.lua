return skeleton() >> shrink(0.5) >> lazy() >> rrt { step = 0.5 }, scenes.simple_passage()
