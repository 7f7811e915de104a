-- SPDX-License-Identifier: MIT-0
-- Thirty-two discs in a warehouse, from places to others between and beside the shelves.
--
--   trellis run examples/warehouse.lua
--
-- docs/teams.md says more.

local shelves = {}
for i = 0, 3 do
  for j = 0, 2 do shelves[#shelves + 1] = box { 3 + 4 * i, 3 + 5 * j, 5 + 4 * i, 6 + 5 * j } end
end

-- Places on a grid that no shelf is near.
local places = {}
for x = 1, 19, 1.8 do
  for y = 1, 19, 1.8 do
    local free = true
    for i = 0, 3 do
      for j = 0, 2 do
        free = free and not (x > 2.5 + 4 * i and x < 5.5 + 4 * i and y > 2.5 + 5 * j and y < 6.5 + 5 * j)
      end
    end
    if free then places[#places + 1] = { x, y } end
  end
end

local function warehouse(count)
  local start, goal = {}, {}
  for i = 1, count do
    start[i] = places[i * 23 % #places + 1]
    goal[i] = places[(i * 41 + 7) % #places + 1]
  end
  return problem { name = count .. " discs", world = world { bounds = {0, 0, 20, 20}, shelves },
                   robot = robots { robot.disc(0.3), count = count }, start = start, goal = goal }
end

local planner = rrt_connect { bound = 0, proposals = 2000 }
return experiment {
  problems   = { warehouse(8), warehouse(16), warehouse(24), warehouse(32) },
  strategies = {
    alone = rrt_connect { proposals = 2000 }, prioritise = prioritise() >> planner,
    couple = couple() >> planner,
  },
  seeds      = 3,
  baseline   = "alone",
  measure    = false,
}
