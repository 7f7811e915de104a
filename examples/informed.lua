-- SPDX-License-Identifier: MIT-0
-- What informed sampling saves in a warehouse: once there is a path, the set that a shorter path can pass through
-- leaves out the corners. So it needs a planner that improves its path; under rrt, which ends with its first one,
-- nothing changes.
--
--   trellis run examples/informed.lua --ablation 0
local shelves = {}
for column = 0, 4 do
  for row = 0, 2 do
    local x, y = 4 + 5 * column, 3 + 6 * row
    shelves[#shelves + 1] = box { x, y, x + 2, y + 4, name = "shelf " .. #shelves + 1 }
  end
end
local warehouse = problem {
  name  = "warehouse",
  world = world { bounds = {0, 0, 32, 24}, table.unpack(shelves) },
  robot = robot.rectangle { 0.8, 0.5 },
  start = {1, 8, 0},
  goal  = {31, 8, 0},
}
local star = rrt_star { step = 1, proposals = 4000, bound = 0 }

return experiment {
  problems   = { warehouse },
  strategies = { star = star, informed = informed() >> star },
  baseline   = "star",
  seeds      = 7,
  measure    = false,
}
