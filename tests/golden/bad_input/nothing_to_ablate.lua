return experiment { problems = scenes.cup(), strategies = { whole = ablations(rrt {}) } }
