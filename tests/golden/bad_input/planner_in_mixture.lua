return 0.5 * lazy() + rrt {}, scenes.cup()
