return finds_paths(at_most(5).nodes())
