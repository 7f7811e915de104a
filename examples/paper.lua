-- SPDX-License-Identifier: GPL-3.0-or-later
-- The methods of Attali et al. 2022, and some beyond them, on its three scenes, with nothing tuned to a scene.
--
--   trellis run examples/paper.lua --out DIR       what scripts/paper does; docs/paper.md has what came out
--   trellis run examples/paper.lua --seeds 3 --cross 0
--   trellis check examples/paper.lua               prints every method's hierarchy
--   trellis help strategies                        the methods      trellis help paper      this experiment's parts
--
-- Every method is written in the standard library from the same parts: stdlib/strategies.lua. docs/methods.md tells for
-- each what was published and what differs.

return experiment {
  problems   = paper.scenes(),
  strategies = paper.methods(),
  seeds      = 15,
  -- Fifteen runs average out what half the usual points leave open.
  measure    = tube { delta = 0.5, points = 2048, pool = 8192 },
  -- Two floors under the cells without samples tell how much of a legacy figure is its floor.
  estimators = { exact(), knn(), kde(), histogram(), legacy(), legacy { floor = 1e-10 } },
  baseline   = "rrt",
  published  = paper.published(),
}
