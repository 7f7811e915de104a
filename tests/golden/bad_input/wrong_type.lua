local guide = shrink {
  0.5,
}
local planner = rrt {
  step = "0.5",
}
return guide >> planner, scenes.cup()
