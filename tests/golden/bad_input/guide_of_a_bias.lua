return skeleton() >> goal_bias(0.1) >> rrt {}, scenes.cup()
