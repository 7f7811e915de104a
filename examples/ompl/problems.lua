-- SPDX-License-Identifier: MIT-0
-- The problems of tests/bench/bench_ompl_guided.cpp: three mazes, and the three scenes of the paper.
return experiment {
  problems = {
    worlds.maze { cells = 6, seed = 1, name = "maze_6" },
    worlds.maze { cells = 9, seed = 2, name = "maze_9" },
    worlds.maze { cells = 12, seed = 3, name = "maze_12" },
    scenes.simple_passage(), scenes.trap(), scenes.cup(),
  },
  strategies = { rrt_connect = rrt_connect {}, skeleton = skeleton() >> rrt_connect {} },
  baseline = "rrt_connect",
}
