local s = lazy() >> rrt {}
return s >> rrt {}, scenes.cup()
