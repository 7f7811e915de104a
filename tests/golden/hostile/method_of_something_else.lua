return (rrt {}).tree(42)
