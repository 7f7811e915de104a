local a = rrt {}
a.step = 0.5
