-- SPDX-License-Identifier: GPL-3.0-or-later
-- The published experiment once more, with the methods as the library that its authors used is known to do them: no
-- effective goal bias, regions never dropped (docs/methods.md). They bear the methods' own names here, so that they
-- stand beside the published figures.
--
--   trellis run examples/parasol.lua --out DIR

local methods = paper.parasol()
for _, method in ipairs(methods) do method[1] = method[1]:gsub("^parasol_", "") end

return experiment {
  problems   = paper.scenes(),
  strategies = methods,
  seeds      = 15,
  measure    = tube { delta = 0.5, points = 2048, pool = 8192 },
  estimators = { exact(), knn(), kde(), histogram(), legacy() },
  baseline   = "rrt",
  published  = paper.published(),
}
