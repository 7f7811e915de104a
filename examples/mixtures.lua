-- SPDX-License-Identifier: MIT-0
-- Several guides for one planner: weighted mixtures, and sequences that take turns.
--
--   trellis run examples/mixtures.lua
--   trellis check examples/mixtures.lua      prints the hierarchies as trees

-- `+` mixes distributions. The weights are normalised, so 0.7*a + 0.3*b is 7*a + 3*b.
local biased = (0.7 * skeleton() + 0.2 * goal_bias(0.2) + 0.1 * bridge_test()) >> rrt { step = 0.5 }

-- `..` alternates between guides in turns of 200 proposals, each informing the next; `sequence` sets the turn's length.
local turns = (skeleton() .. shrink(0.5)) >> rrt { step = 0.5 }
local short = sequence { skeleton(), shrink(0.5), turn = 50 } >> rrt { step = 0.5 }

-- A guide before a mixture guides each of its parts that searches a space: this is
-- (skeleton() >> shrink(0.7)) + (skeleton() >> lazy()).
local nested = skeleton() >> (shrink(0.7) + lazy()) >> rrt { step = 0.5 }

-- A loop computes a family of spaces: robots of a quarter, a half and three quarters of the size, each guiding the
-- next.
local growing = rrt { step = 0.5 }
for _, scale in ipairs { 0.75, 0.5, 0.25 } do growing = shrink(scale) >> growing end

return experiment {
  problems   = { scenes.simple_passage(), scenes.cup() },
  strategies = {                      -- a list of pairs is reported in its own order
    { "rrt", rrt { step = 0.5 } },
    { "biased", biased },
    { "turns", turns },
    { "short turns", short },
    { "nested", nested },
    { "growing", growing },
  },
  seeds   = 3,
  measure = tube { delta = 0.5 },
}
