return rrt {}, scenes.load "/no/such/scene.txt"
