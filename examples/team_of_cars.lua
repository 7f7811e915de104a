-- SPDX-License-Identifier: MIT-0
-- Four cars at a crossing that only go forwards. One car after another follows the others' motion in time, or waits.
--
--   trellis run examples/team_of_cars.lua
--
-- docs/teams.md says more.

local crossing = problem {
  name   = "crossing",
  world  = world { bounds = {0, 0, 10, 10}, box {0, 0, 3.5, 3.5},
                   box {6.5, 0, 10, 3.5}, box {0, 6.5, 3.5, 10}, box {6.5, 6.5, 10, 10} },
  robot  = robots { robot.rectangle(0.5, 0.3), count = 4 },
  motion = motion.car { wheelbase = 0.3, min_speed = 0, max_speed = 1, max_steering = 0.7 },
  start  = { {1, 4.5, 0}, {9, 5.5, math.pi}, {5.5, 1, math.pi / 2}, {4.5, 9, -math.pi / 2} },
  goal   = { {9, 4.5, 0}, {1, 5.5, math.pi}, {5.5, 9, math.pi / 2}, {4.5, 1, -math.pi / 2} },
  goal_tolerance = 0.5,
}
local planner = kinodynamic_rrt { extend = "curves", bound = 0, proposals = 20000 }

return experiment {
  problems   = { crossing },
  strategies = { alone = kinodynamic_rrt { extend = "curves", proposals = 20000 }, prioritise = prioritise() >> planner,
                 decouple = decouple() >> planner, couple = couple { where = "path" } >> planner },
  seeds      = 11,
  baseline   = "alone",
  measure    = false,
}
