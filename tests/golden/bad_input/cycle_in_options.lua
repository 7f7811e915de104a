local options = { step = 0.5 }
options.iterations = options
options.step = options
return rrt(options), scenes.cup()
