return rrt {}, scenes.trap { collision = "bullet" }
