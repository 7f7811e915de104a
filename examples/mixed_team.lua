-- SPDX-License-Identifier: MIT-0
-- An arm, a disc that drives on the floor and a drone in one room: they must not touch each other.
--
--   trellis run examples/mixed_team.lua
--
-- The arm and the disc are robots of the plane, which stand on z = 0 with a height. The arm reaches through the gate
-- that the disc has to pass, and the drone changes sides above the wall. docs/teams.md says more.

local room = world { bounds = {-3, -3, -0.2, 3, 3, 2},
                     box {-0.1, -3, -0.2, 0.1, -0.6, 1.3}, box {-0.1, 0.6, -0.2, 0.1, 3, 1.3} }
local team = robots {
  robot.arm { links = {0.8, 0.8}, width = 0.12, base = {-1.2, 0} },
  robot.disc(0.25),
  robot.rigid { box {-0.25, -0.25, -0.06, 0.25, 0.25, 0.06} },
  height = 0.5,
}
local gate = problem {
  name = "gate", world = room, robot = team,
  start = { {0.1, -0.1}, {-2, -2}, pose {2, -2, 1} },
  goal  = { {2.5, -0.4}, {2, 2}, pose {-2, 2, 1, axis = {0, 0, 1}, angle = math.pi / 2} },
}
local planner = rrt_connect { bound = 0, proposals = 20000 }

return experiment {
  problems   = { gate },
  strategies = { alone = rrt_connect { proposals = 20000 },
                 prioritise = prioritise() >> planner, couple = couple() >> planner },
  seeds      = 11,
  baseline   = "alone",
  measure    = false,
}
