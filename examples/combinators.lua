-- SPDX-License-Identifier: GPL-3.0-or-later
-- Guides that follow, race and weigh each other, and instances divided at sub-goals; any of them within any other.
--
--   trellis run examples/combinators.lua
--   trellis check examples/combinators.lua      prints the hierarchies as trees

local step = rrt { step = 0.5 }

-- `schedule`: each robot guides until it is refuted, then the next larger one, informed by the path of the one before.
-- It is schedule { shrink { 0.3, evidence = 50 }, shrink { 0.6, evidence = 50 }, shrink { 0.9, evidence = 50 } }.
local scheduled = schedule { shrink, scale = {0.3, 0.6, 0.9}, evidence = 50 } >> step

-- `race`: the spaces are searched in turn, by slices of proposals that double; the first path found guides.
local raced = race { shrink(0.9), lazy(), slice = 50 } >> step

-- `split`: the instance is divided at a sub-goal on the guide's path, and each half once more. Each quarter has a
-- skeleton and a planner of its own.
local divided = skeleton() >> split { step, depth = 2 }

-- `blend` by the measured efficiency: the weights follow the densities where the search came nearer to its end.
local weighed = blend { skeleton(), shrink(0.5), credit = "efficiency" } >> step

-- Any of them in any other: one of the two that race is itself a schedule, whose second part is a blend; the searches
-- of all their spaces are guided by skeletons, and shrink(0.7) has a planner that divides its instances.
local mixed = skeleton()
    >> race {
      schedule { shrink(0.4), blend { shrink { 0.7, planner = split { rrt_connect {} } }, goal_bias(0.1) } },
      lazy() .. identity(),
    }
    >> split { step }

return experiment {
  problems   = { scenes.trap() },
  strategies = {
    { "rrt", step },
    { "scheduled", scheduled },
    { "raced", raced },
    { "divided", divided },
    { "weighed", weighed },
    { "mixed", mixed },
  },
  seeds   = 3,
  measure = tube { delta = 0.5 },
}
