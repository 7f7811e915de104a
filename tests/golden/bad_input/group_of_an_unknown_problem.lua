return experiment {
  problems = scenes.cup(),
  strategies = { rrt = rrt {} },
  groups = { { "paper", { scenes.cup(), scenes.trap() } } },
}
