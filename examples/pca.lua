-- SPDX-License-Identifier: MIT-0
-- A learnt subspace: the guide searches an arm of four links in the plane through start and goal along which the
-- valid configurations vary most.
--
--   trellis run examples/pca.lua
--
-- The arm has to retract a little to pass below the bar. Fitting the plane costs validity checks, which count in its
-- level: see the table of the levels.

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
