return shrink { 0.5, follow = "waypoint" } >> rrt {}, scenes.cup()
