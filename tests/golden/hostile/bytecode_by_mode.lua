return load("return 1", "chunk", "b")
