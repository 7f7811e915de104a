-- SPDX-License-Identifier: MIT-0
-- Eight discs that change places in a room, and which division of the team finds their paths with the fewest checks.
--
--   trellis run examples/many_robots.lua
--
-- docs/teams.md says more.

local start, goal = {}, {}
for i = 1, 8 do
  local x, y = 4 * math.cos(i * math.pi / 4), 4 * math.sin(i * math.pi / 4)
  start[i], goal[i] = { 5 + x, 5 + y }, { 5 - x, 5 - y }
end
local room = problem { world = world { bounds = {0, 0, 10, 10} }, robot = robots { robot.disc(0.7), count = 8 },
                       start = start, goal = goal, name = "room" }
local planner = rrt_connect { bound = 0, proposals = 20000 }

return experiment {
  problems   = { room },
  strategies = {
    alone = rrt_connect { proposals = 20000 }, drrt = drrt { proposals = 20000 },
    prioritise = prioritise() >> planner, couple = couple() >> planner, decouple = decouple { tries = 4 } >> planner,
    team = team { 1, 5 } >> planner,
  },
  seeds      = 11,
  baseline   = "alone",
  measure    = false,
}
