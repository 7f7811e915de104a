return rrt {}, scenes.trap { colision = "fcl" }
