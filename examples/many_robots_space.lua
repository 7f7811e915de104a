-- SPDX-License-Identifier: MIT-0
-- Twelve bars in space that change places with those opposite, and turn over meanwhile: 72 degrees of freedom.
--
--   trellis run examples/many_robots_space.lua
--
-- A start or goal is a pose for each robot. docs/teams.md says more.

local start, goal = {}, {}
for i = 1, 12 do
  local angle = i * math.pi / 6
  local x, y = 2.2 * math.cos(angle), 2.2 * math.sin(angle)
  start[i] = pose { 3 + x, 3 + y, 3, axis = {0, 0, 1}, angle = angle }
  goal[i]  = pose { 3 - x, 3 - y, 3, axis = {x, y, 0}, angle = math.pi / 2 }
end
local room = problem { world = world { bounds = {0, 0, 0, 6, 6, 6} }, start = start, goal = goal, name = "room",
                       robot = robots { robot.rigid { box {-0.6, -0.15, -0.15, 0.6, 0.15, 0.15} }, count = 12 } }
local planner = rrt_connect { bound = 0, proposals = 20000 }

return experiment {
  problems   = { room },
  strategies = { alone = rrt_connect { proposals = 20000 },
                 prioritise = prioritise() >> planner, couple = couple() >> planner },
  seeds      = 11,
  baseline   = "alone",
  measure    = false,
}
