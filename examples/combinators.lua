-- SPDX-License-Identifier: MIT-0
-- Guides in schedules, races and weighted blends, and instances divided at sub-goals; each combines with all others.
--
--   trellis run examples/combinators.lua
--   trellis check examples/combinators.lua      prints the hierarchies as trees

local step = rrt { step = 0.5 }

-- `schedule`: each robot guides until its path is refuted; then the next larger one guides, informed by that path.
-- It is schedule { shrink { 0.3, evidence = 50 }, shrink { 0.6, evidence = 50 }, shrink { 0.9, evidence = 50 } }.
local scheduled = schedule { shrink, scale = {0.3, 0.6, 0.9}, evidence = 50 } >> step

-- `race`: searches the spaces in turn, in slices of proposals that double; the first path found guides.
local raced = race { shrink(0.9), lazy(), slice = 50 } >> step

-- `split`: divides the instance at a sub-goal on the guide's path, and each half once more. Each quarter has its own
-- skeleton and its own planner.
local divided = skeleton() >> split { step, depth = 2 }

-- `blend` by the measured efficiency: it adapts the weights to the densities where the search made progress.
local weighed = blend { skeleton(), shrink(0.5), credit = "efficiency" } >> step

-- Combinators nest: one of the two guides in the race is a schedule, whose second part is a blend. Skeletons guide the
-- searches of all their spaces, and shrink(0.7) has a planner that divides its instances.
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
