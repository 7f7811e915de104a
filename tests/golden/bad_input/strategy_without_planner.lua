return experiment {
  problems = { scenes.cup() },
  strategies = { nested = skeleton() >> shrink(0.5) },
}
