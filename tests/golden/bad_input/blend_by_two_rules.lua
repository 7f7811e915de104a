return blend { skeleton(), lazy(), credit = "efficiency", rule = "exp3" } >> rrt {}, scenes.cup()
