-- SPDX-License-Identifier: MIT-0
-- Which guides pay for rigid bodies in space, in checks and in CPU time: a plank and a slot, and a box in a maze, which
-- is a plan of the Robotics Library (rl).
--
--   trellis run examples/real/guides_in_space.lua --cross 0
--
-- docs/space.md has the table, and that of hook.lua.

local blocks = world {
  bounds = {0, 0, 0, 10, 10, 10},
  box { 4, 0, 0, 6, 10, 4.6, name = "lower block" },
  box { 4, 0, 5.4, 6, 10, 10, name = "upper block" },
  sphere { 2.5, 5, 5, 0.6, name = "ball" },
}

local slot = problem {
  name  = "slot",
  world = blocks,
  robot = robot.rigid { box {-0.8, -0.5, -0.1, 0.8, 0.5, 0.1} },
  start = pose { 1, 5, 5, axis = {0, 1, 0}, angle = math.pi / 2 },
  goal  = pose { 9, 5, 5, axis = {1, 0, 0}, angle = math.pi / 2 },
}

local maze = scenes.load "rl/rlplan/box-6d-300505_maze_rrtConCon.mdl.sixDof.xml"

local connect = rrt_connect { step = 1, proposals = 1000000 }
local tree = rrt { step = 1, proposals = 300000 }

return experiment {
  problems   = { slot, maze },
  strategies = {
    { "rrt_connect",                       connect },
    { "rrt",                               tree },
    { "skeleton >> rrt_connect",           skeleton() >> connect },
    { "skeleton >> rrt",                   skeleton() >> tree },
    { "regions >> rrt",                    skeleton { follow = "regions" } >> tree },
    { "skeleton >> shrink >> rrt_connect", skeleton() >> shrink(0.7) >> connect },
    { "workspace >> rrt_connect",          workspace() >> connect },
    { "decomposition >> rrt",              decomposition() >> tree },
    { "decomposition >> rrt_connect",      decomposition() >> connect },
  },
  seeds   = 20,
  measure = tube { delta = 1 },
}
