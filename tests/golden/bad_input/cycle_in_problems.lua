local problems = { scenes.cup() }
problems[2] = { problems }
return experiment { problems = problems, strategies = { plain = rrt {} } }
