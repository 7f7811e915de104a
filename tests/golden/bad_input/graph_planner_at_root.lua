return experiment {
  problems = { scenes.cup() },
  strategies = { graph = graph_search {} },
}
