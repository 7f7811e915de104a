return { strategy = rrt {} }
