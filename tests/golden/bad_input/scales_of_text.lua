return strategies.relaxation { scales = "half" } >> rrt {}, scenes.cup()
