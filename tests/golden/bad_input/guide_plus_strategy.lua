return lazy() + (lazy() >> rrt {}), scenes.cup()
