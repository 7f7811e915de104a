return experiment {
  problems = scenes.cup(),
  strategies = { rrt = rrt {} },
  measure = knn { k = 5 },
}
