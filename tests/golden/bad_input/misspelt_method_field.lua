return strategies.dr_rrt {
  regon = 3 }, scenes.cup()
