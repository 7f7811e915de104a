return experiment {
  problems = scenes.cup(),
  strategies = { rrt = rrt {} },
  measure = tube { distance = "planer" },
}
