-- SPDX-License-Identifier: MIT-0
-- A rigid body in space: a plank that has to turn to pass the slot between two blocks.
--
--   trellis run examples/space.lua
--
-- Six bounds make a world of space. A body's configuration is its position and a quaternion; a pose is easier to write.
-- The guides are those of the plane: `workspace` searches the positions of the reference point on a grid, `shrink`
-- plans for a plank of half the size, `lazy` assumes that there are no obstacles until edges of its path turn out to be
-- blocked.

local blocks = world {
  bounds = {0, 0, 0, 10, 10, 10},
  box { 4, 0, 0, 6, 10, 4.6, name = "lower block" },
  box { 4, 0, 5.4, 6, 10, 10, name = "upper block" },
  sphere { 2.5, 5, 5, 0.6, name = "ball" },
}

local plank = robot.rigid { box {-0.8, -0.5, -0.1, 0.8, 0.5, 0.1} }

local slot = problem {
  name  = "slot",
  world = blocks,
  robot = plank,
  start = pose { 1, 5, 5, axis = {0, 1, 0}, angle = math.pi / 2 },
  goal  = pose { 9, 5, 5, axis = {1, 0, 0}, angle = math.pi / 2 },
}

return experiment {
  problems   = { slot },
  strategies = {
    rrt_connect = rrt_connect { step = 1 },
    shrink      = shrink(0.5) >> rrt_connect { step = 1 },
    nested      = workspace() >> shrink(0.5) >> lazy() >> rrt_connect { step = 1 },
  },
  seeds   = 5,
  measure = tube { delta = 1 },
}
