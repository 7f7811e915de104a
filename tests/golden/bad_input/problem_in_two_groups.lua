return experiment {
  problems = scenes.cup(),
  strategies = { rrt = rrt {} },
  groups = { { "one", scenes.cup() }, { "two", scenes.cup() } },
}
