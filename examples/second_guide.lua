-- SPDX-License-Identifier: MIT-0
-- Does a second guide pay? Hierarchies of two guides in worlds that no strategy was tuned on.
--
--   trellis run examples/second_guide.lua --report levels
--
-- Each strategy is also run without each of its guides, on the same seeds: the verdicts say whether a level saves more
-- checks than it costs. docs/pays.md has the table.

local planners = { rrt = rrt { step = 0.5 }, rrt_connect = rrt_connect { step = 0.5 } }
local strategies = {}
for _, name in ipairs { "rrt_connect", "rrt" } do
  local planner = planners[name]
  strategies[#strategies + 1] = { name, planner }
  for _, guide in ipairs { shrink(0.5), shrink(0.9), lazy() } do
    local nested = skeleton() >> guide >> planner
    strategies[#strategies + 1] = { tostring(nested), nested }
  end
end

return experiment {
  problems = {
    worlds.false_gaps { rows = 6, kind = "narrow", name = "narrow_gaps_6" },
    worlds.false_gaps { rows = 6, kind = "bent", name = "bent_gaps_6" },
    worlds.false_gaps { rows = 4, kind = "mixed", gaps = 8, seed = 2, name = "mixed_gaps_4" },
    worlds.rooms { rooms = 4, seed = 2, name = "rooms_4" },
    worlds.maze { cells = 6, seed = 1, name = "maze_6" },
    worlds.slalom { name = "slalom_8" },
  },
  strategies = strategies,
  baseline   = "rrt_connect",
  seeds      = 15,
  measure    = false,
  ablation   = 20,
}
