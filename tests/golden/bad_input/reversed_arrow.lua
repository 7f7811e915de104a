return rrt {} << lazy(), scenes.cup()
