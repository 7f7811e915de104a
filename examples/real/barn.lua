-- SPDX-License-Identifier: MIT-0
-- BARN, the benchmark of autonomous robot navigation: 25 fields of cylinders. The robot is a disc as wide as the
-- Jackal, the benchmark's robot; start and goal are those of the reference paths.
--
--   trellis run examples/real/barn.lua --jobs 2

return experiment {
  problems   = scenes.load "barn/obstacles.csv",
  strategies = {
    rrt_connect = rrt_connect { step = 0.5 },
    skeleton    = skeleton() >> rrt_connect { step = 0.5 },
  },
  seeds    = 1,
  shortcut = 100,
  measure  = tube { delta = 0.5 },
}
