-- SPDX-License-Identifier: MIT-0
-- As correlation.lua, for a plank in space.
--
--   trellis run examples/pays/correlation_space.lua --quiet --json space.json
--   trellis report space.json --report costs

local guides = require "guides"

return experiment {
  problems = {
    worlds.slot {},
    worlds.windows { walls = 1, name = "windows_1" },
    worlds.windows { walls = 2, seed = 81, name = "windows_81" },
    worlds.floating_boxes { name = "floating_boxes_60" },
    worlds.floating_boxes { boxes = 100, seed = 82, name = "floating_boxes_82" },
    worlds.floating_boxes { boxes = 150, seed = 83, name = "floating_boxes_83" },
  },
  strategies = guides.over("rrt", rrt, { step = 0.5, proposals = 20000 }, "space"),
  baseline   = "rrt",
  seeds      = 5,
  measure    = tube { delta = 0.5 },
  ablation   = 0,
}
