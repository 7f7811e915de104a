return disc {1, 1, 0}
