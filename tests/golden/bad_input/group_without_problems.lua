return experiment {
  problems = scenes.cup(),
  strategies = { rrt = rrt {} },
  groups = { { "one", tuned = true } },
}
