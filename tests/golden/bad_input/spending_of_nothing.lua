return spends(at_most(5))
