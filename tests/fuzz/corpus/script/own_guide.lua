local half = guiding_space { name = "half", robot = function(instance) return instance.robot:scaled(0.5) end,
  heuristic = function(found, instance) return along(found.path) end }
return race { half, skeleton() } >> rrt {}, scenes.cup()
