return rrt {}, scenes.trap(3)
