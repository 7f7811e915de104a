return experiment { problems = scenes.trap(), strategies = { a = rrt {}, b = prm {} }, published = published { source = "X 1999", figures = { tarp = { a = {1, 2} } } } }
