-- SPDX-License-Identifier: MIT-0
-- Obstacles merged into convex hulls: S has less free space than C, and every path found in it is valid in C.
--
--   trellis run examples/aggregate.lua
--
-- A pile of boxes with gaps that are too narrow for the robot, and pockets that are dead ends. Among the hulls only the
-- route around the pile remains.

local pile = { bounds = {0, 0, 10, 10} }
for column = 0, 3 do
  for row = 0, 5 do
    local x, y = 3 + column * 1.1, 1.5 + row * 1.2
    pile[#pile + 1] = box {x, y, x + 0.7, y + 0.7}
  end
end

return experiment {
  problems = {
    problem {
      name = "pile", world = world(pile), robot = robot.rectangle(0.6, 0.2), start = {1, 5, 0}, goal = {9, 5, 0},
    },
  },
  strategies = {
    { "rrt",       rrt { step = 0.5 } },
    { "aggregate", aggregate(0.3) >> rrt { step = 0.5 } },
    { "coarser",   aggregate(1) >> rrt { step = 0.5 } },
    -- a path found in S is valid in C: the guide proposes its points themselves
    { "waypoints", aggregate { 0.3, follow = "waypoints" } >> rrt { step = 0.5 } },
  },
  seeds   = 3,
  measure = tube { delta = 0.5 },
}
