return problem {
  world = world { bounds = {0, 0, 10, 10} }, robot = robot.point(), start = {1, 1},
}
