return shrink { 0.5, planner = lazy() } >> rrt {}, scenes.cup()
