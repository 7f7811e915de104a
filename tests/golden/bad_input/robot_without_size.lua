return robot.rectangle(0.6, 0)
