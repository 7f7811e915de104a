-- SPDX-License-Identifier: MIT-0
-- Anytime planners: they shorten their path after the first one, with the same number of proposals each.
--
--   trellis run examples/optimal.lua
--
-- RRT and PRM stop at their first path. RRT* and PRM* converge to the shortest one, and validate every motion to a
-- neighbour. The lazy ones validate such a motion only when it lies on a shortest path: Lazy-PRM* finds the paths of
-- PRM*. `informed()` receives each path found and samples the set of states that a shorter one could visit. Compare
-- path lengths and validity checks in the summary.

local around = problem {
  name  = "around",
  world = world { bounds = {0, 0, 12, 12}, box {5, 3, 7, 7, name = "block"} },
  robot = robot.rigid { box {-0.3, -0.1, 0.3, 0.1} },
  start = {4, 6, 0},
  goal  = {8, 6, 0},
}

local spend = { proposals = 3000, improve = 3000 }

return experiment {
  problems   = { around },
  strategies = {
    rrt           = rrt(),
    prm           = prm(),
    rrt_star      = rrt_star(spend),
    prm_star      = prm_star(spend),
    lazy_prm_star = lazy_prm_star(spend),
    lazy_rrg_star = lazy_rrg_star(spend),
    informed_rrt_star      = informed() >> rrt_star(spend),
    -- With a bound the run often ends with the planner that runs beside it, and with that one's path.
    informed_lazy_prm_star = informed() >> lazy_prm_star { proposals = 3000, improve = 3000, bound = 0 },
  },
  seeds   = 5,
  measure = tube { delta = 0.5 },
}
