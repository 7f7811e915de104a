return skeleton { planner = split { graph_search {} } } >> rrt {}, scenes.cup()
