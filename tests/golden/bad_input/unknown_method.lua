return experiment {
  problems = paper.scenes(),
  strategies = paper.methods { ircc = {} } }
