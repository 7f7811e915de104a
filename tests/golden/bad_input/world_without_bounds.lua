return world { box {6, 0, 7, 4} }
