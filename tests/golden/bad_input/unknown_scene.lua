return rrt {}, scenes.simple_pasage()
