-- SPDX-License-Identifier: MIT-0
-- Paths from one world guide in other worlds: Lightning. Run learn.lua first; its comment shows how.
--
--   trellis run examples/experience/use.lua
--
-- No stored path leads from the left to the right. `experience` takes the stored paths with the nearest ends, connects
-- them where they come near each other, and follows the path with the fewest violations in the present world: from the
-- left to the middle on one path, and on to the right on another. It proposes the points of the path one after another;
-- where the path is blocked, it proposes points nearby.
--
-- `path_database` follows no path: each node of the tree has a cost to go by the stored paths near it, and the node
-- with the least one is extended. Motions of paths that are blocked leave the database while the search continues.
--
-- The second world has a box in each of the rooms, on the stored paths. In the third the gaps are elsewhere, so the
-- library misleads: the row of the root shows the cost of following it.

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
    crossing("boxes on the path", walls(box {1.3, 2.6, 2.2, 3.4}, box {4.6, 3.6, 5.4, 4.4}, box {7.8, 2.6, 8.6, 3.4})),
    crossing("gaps elsewhere", elsewhere),
  },
  strategies = {
    rrt = rrt { step = 0.5 },
    lightning = experience { db = "paths.db" } >> rrt { step = 0.5 },
    database = path_database { db = "paths.db" } >> rrt { step = 0.5 },
  },
  baseline = "rrt",
  seeds = 30,
}
