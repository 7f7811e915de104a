-- SPDX-License-Identifier: GPL-3.0-or-later
-- A learnt subspace: an arm of six links is searched in the flat of three dimensions that goes through start and goal
-- and along which the valid configurations spread most.
--
--   trellis run examples/pca.lua
--
-- What the subspace is fitted to costs validity checks, and they are its level's: see the table of the levels.

local arm = problem {
  name = "six_links",
  robot = robot.arm { links = {1, 1, 1, 1, 0.7, 0.7}, width = 0.1, base = {5, 1} },
  world = world {
    bounds = {0, 0, 10, 10},
    box {4.2, 4.5, 5.8, 5.2},
    box {2, 2, 3, 3.2},
  },
  start = {0.7, 0.3, 0.2, 0.1, 0.2, 0.1},
  goal = {2.4, -0.3, -0.2, -0.2, 0.1, -0.1},
}

local planner = rrt { step = 0.1 }

return experiment {
  problems   = { arm },
  strategies = {
    rrt = planner,
    pca = pca { dimensions = 3, samples = 50, planner = rrt_connect { step = 0.1 } } >> planner,
  },
  seeds   = 5,
  measure = tube { delta = 0.1 },
}
