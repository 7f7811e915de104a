return experiment { problems = scenes.trap(), strategies = { a = rrt {}, b = prm {} }, published = { trap = { a = {1, 2} } } }
