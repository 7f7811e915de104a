return experiment { problems = scenes.cup(), strategies = { rrt = rrt {} }, estimators = { exact(), knn } }
