local bow = polygon { {1, 1}, {3, 3}, {3, 1}, {1, 3} }
return rrt {}, scenes.cup()
