-- SPDX-License-Identifier: MIT-0
-- As correlation.lua, in worlds that no choice of the measure has seen: random ones with seeds of their own.
--
--   trellis run examples/pays/correlation_new.lua --quiet --json new.json
--   trellis report new.json --report costs

local guides = require "guides"

return experiment {
  problems = {
    worlds.boxes { boxes = 60, seed = 71, name = "boxes_71" },
    worlds.boxes { boxes = 160, seed = 72, name = "boxes_72" },
    worlds.rooms { rooms = 3, seed = 73, name = "rooms_73" },
    worlds.rooms { rooms = 4, seed = 74, name = "rooms_74" },
    worlds.maze { cells = 6, seed = 75, name = "maze_75" },
    worlds.maze { cells = 8, seed = 76, name = "maze_76" },
    worlds.false_gaps { rows = 2, kind = "bent", seed = 77, name = "bent_gaps_77" },
    worlds.false_gaps { rows = 3, kind = "mixed", gaps = 6, seed = 78, name = "mixed_gaps_78" },
    worlds.slalom { gates = 4, name = "slalom_4" },
    worlds.dead_ends { pockets = 3, name = "dead_ends_3" },
    worlds.bug_trap(),
  },
  strategies = guides.over("rrt", rrt, { step = 0.5, proposals = 20000 }),
  baseline   = "rrt",
  seeds      = 5,
  measure    = tube { delta = 0.5 },
  ablation   = 0,
}
