-- SPDX-License-Identifier: MIT-0
-- A benchmark world: the circle world of OMPL's tests, a point among discs, with its 100 queries.
--
--   trellis run examples/real/circles.lua --jobs 2
--
-- Trellis searches for the file beside this script and then in the folder of scenes (TRELLIS_SCENES). Each query is a
-- problem, so the table at the end compares the strategies over all of them.

local queries = scenes.load "ompl_tests/circle_obstacles.txt"

-- The world is about 60 metres wide: steps of 2 metres suit it.
return experiment {
  problems   = queries,
  strategies = {
    prm         = prm {},
    rrt         = rrt { step = 2 },
    rrt_connect = rrt_connect { step = 2 },
    skeleton    = skeleton() >> rrt { step = 2 },
  },
  seeds    = 1,
  shortcut = 100,    -- paths are shortened before their lengths are compared
  measure  = tube { delta = 2 },
}
