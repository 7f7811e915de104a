return world { bounds = {0, 0, 10, 10}, box {6, 0, 4, 4.75} }
