-- SPDX-License-Identifier: GPL-3.0-or-later
-- What was learnt in one world guides in others: Lightning. Run learn.lua first; it says how.
--
--   trellis run examples/experience/use.lua
--
-- Nobody went from the left to the right yet. `experience` takes the stored paths whose ends are nearest, joins them
-- where they come near each other, and goes the way that the present world violates least: from the left to the middle
-- by one path, and on to the right by another. Its points are proposed one after the other; where the way is blocked,
-- what is near it.
--
-- The second world has a box in each of the rooms, in the way of what was learnt. In the third the gaps are elsewhere,
-- so the library misleads: what it costs to follow it there is in the row of the root.

local walls = require "walls"
local arm = robot.rectangle(0.6, 0.2)
local start, goal = {1, 5, 0}, {9, 5, 0}

local function crossing(name, where)
  return problem { name = name, world = where, robot = arm, start = start, goal = goal }
end

local elsewhere = world {
  bounds = {0, 0, 10, 10},
  box {3, 0, 3.5, 8.3}, box {3, 8.8, 3.5, 10},
  box {6.5, 0, 7, 8.3}, box {6.5, 8.8, 7, 10},
}

return experiment {
  problems = {
    crossing("as learnt", walls()),
    crossing("boxes in the way", walls(box {1.3, 2.6, 2.2, 3.4}, box {4.6, 3.6, 5.4, 4.4}, box {7.8, 2.6, 8.6, 3.4})),
    crossing("gaps elsewhere", elsewhere),
  },
  strategies = {
    rrt = rrt { step = 0.5 },
    lightning = experience { db = "paths.db" } >> rrt { step = 0.5 },
  },
  baseline = "rrt",
  seeds = 30,
}
