-- SPDX-License-Identifier: GPL-3.0-or-later
-- A learnt subspace: an arm of four links is searched in the plane that goes through start and goal and along which the
-- valid configurations spread most.
--
--   trellis run examples/pca.lua
--
-- The arm has to draw in a little to pass below the bar. What the plane is fitted to costs validity checks, and they
-- are its level's: see the table of the levels.

local arm = problem {
  name = "four_links",
  robot = robot.arm { links = {1.2, 1.2, 1.2, 1}, width = 0.1, base = {5, 1} },
  world = world {
    bounds = {0, 0, 10, 10},
    box {4.7, 5.35, 5.3, 5.5},
  },
  start = {0.9, 0.3, 0.2, 0.1},
  goal = {2.2, -0.3, -0.2, -0.1},
}

local planner = rrt { step = 0.2 }

return experiment {
  problems   = { arm },
  strategies = {
    rrt = planner,
    pca = pca { dimensions = 2, samples = 50, planner = rrt_connect { step = 0.2 } } >> planner,
  },
  seeds   = 5,
  measure = tube { delta = 0.1 },
}
