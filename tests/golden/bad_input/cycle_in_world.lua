local rocks = { disc {1, 1, 0.5} }
rocks[2] = rocks
return world { bounds = {0, 0, 10, 10}, rocks }
