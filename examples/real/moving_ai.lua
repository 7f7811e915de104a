-- SPDX-License-Identifier: MIT-0
-- City maps of the Moving AI Lab: a point among blocked cells of 1 m. Its queries are sorted by length; these are the
-- longest ten of Berlin.
--
--   trellis run examples/real/moving_ai.lua --jobs 2
--   trellis scene bench_mr/moving_ai/Berlin_0_256.map.scen --problem Berlin_0_256/930 --png berlin.png

local queries = scenes.load("bench_mr/moving_ai/Berlin_0_256.map.scen", { resolution = 0.2 })

return experiment {
  problems   = table.move(queries, #queries - 9, #queries, 1, {}),
  strategies = {
    rrt_connect = rrt_connect { step = 10 },
    workspace   = workspace { cell = 4 } >> rrt_connect { step = 10 },
  },
  seeds    = 1,
  shortcut = 100,
  measure  = tube { delta = 5 },
}
