return spends(at_most(5).nodes().by(0.2))
