local mine = target {
  sample = function(context) return context.path[1] end,
}
return experiment { problems = scenes.cup(), strategies = { rrt = rrt {} }, measure = mine }
