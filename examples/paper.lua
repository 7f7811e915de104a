-- SPDX-License-Identifier: MIT-0
-- The methods of Attali et al. 2022, and further ones, on its three scenes, without tuning for a scene.
--
--   trellis run examples/paper.lua --out DIR       what scripts/paper does; docs/paper.md has what came out
--   trellis run examples/paper.lua --seeds 3 --cross 0
--   trellis check examples/paper.lua               prints every method's hierarchy
--   trellis help strategies                        the methods
--
-- The standard library composes every method from the same parts: stdlib/strategies.lua. docs/methods.md lists for each
-- the published method and the differences. paper/attali.lua has the parts of this experiment; paper/compare.py
-- compares its results with the figures of the paper:
--
--   python3 examples/paper/compare.py DIR

local attali = require "paper.attali"

return experiment {
  problems   = attali.scenes(),
  strategies = attali.methods(),
  seeds      = 15,
  -- Fifteen runs average out the additional noise of half the usual number of points.
  measure    = tube { delta = 0.5, points = 2048, pool = 8192 },
  estimators = { exact(), knn() },
  baseline   = "rrt",
}
