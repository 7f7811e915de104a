-- SPDX-License-Identifier: MIT-0
-- The published experiment again, with the methods as in the library that its authors used: no
-- effective goal bias, regions never dropped (docs/methods.md). The methods have their own names here, by which
-- paper/compare.py finds their published figures.
--
--   trellis run examples/parasol.lua --out DIR
--   python3 examples/paper/compare.py DIR

local attali = require "paper.attali"

return experiment {
  problems   = attali.scenes(),
  strategies = attali.presets(),
  seeds      = 15,
  measure    = tube { delta = 0.5, points = 2048, pool = 8192 },
  estimators = { exact(), knn() },
  baseline   = "rrt",
}
