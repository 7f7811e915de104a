return experiment {
  problems = scenes.cup(),
  strategies = { nested = shrink(0.5) >> rrt {}, rrt = rrt {} },
  ablate = { "nestd" },
}
