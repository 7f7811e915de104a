return (-0.5 * lazy() + shrink(0.5)) >> rrt {}, scenes.cup()
