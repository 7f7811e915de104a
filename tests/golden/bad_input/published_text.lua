return experiment { problems = scenes.trap(), strategies = { a = rrt {}, b = prm {} }, published = published { source = "X 1999", figures = { trap = { a = "9.5" } } } }
