return rrt {}
