return problem { world = robot.point(), robot = robot.point(), start = {1, 1}, goal = {2, 2} }
