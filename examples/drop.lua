-- SPDX-License-Identifier: MIT-0
-- Obstacles removed from S by name; each returns when it refutes a path in C.
--
--   trellis run examples/drop.lua
--
-- Two walls with doors: if the doors are open, the path found without them is valid in C at once.

local doors = world {
  bounds = {0, 0, 10, 10},
  box {3, 0, 3.4, 4, name = "left wall, lower"},
  box {3, 6, 3.4, 10, name = "left wall, upper"},
  box {3.1, 4.8, 3.3, 6, name = "left door"},
  box {6.6, 0, 7, 6, name = "right wall, lower"},
  box {6.6, 8, 7, 10, name = "right wall, upper"},
  box {6.7, 6, 6.9, 7.1, name = "right door"},
}

return experiment {
  problems = {
    problem {
      name = "doors", world = doors, robot = robot.rectangle(0.6, 0.2), start = {1, 2, 0}, goal = {9, 2, 0},
    },
  },
  strategies = {
    { "rrt",         rrt { step = 0.5 } },
    { "doors",       drop { "left door", "right door" } >> rrt { step = 0.5 } },
    -- without names the guide removes every obstacle
    { "all of them", drop() >> rrt { step = 0.5 } },
  },
  seeds   = 3,
  measure = tube { delta = 0.5 },
}
