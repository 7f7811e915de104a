-- SPDX-License-Identifier: MIT-0
-- A box of 3 m x 0.5 m x 0.5 m in a maze of 30 m x 30 m x 2 m: a plan of the Robotics Library (rl), with its mesh.
--
--   trellis run examples/real/box_in_maze.lua
--
-- The report says which level pays. The positions found on a grid do: the nested strategy also plans for a smaller box,
-- whose paths cut corners that the box cannot take, and costs more than it saves. --seeds 20 shows both.

local plan = scenes.load "rl/rlplan/box-6d-300505_maze_rrtConCon.mdl.sixDof.xml"
local planner = rrt_connect { step = 1, proposals = 1000000 }

return experiment {
  problems   = plan,
  strategies = {
    { "rrt_connect", planner },
    { "workspace",   workspace() >> planner },
    { "nested",      workspace() >> shrink(0.7) >> planner },
  },
  seeds   = 5,
  measure = tube { delta = 1 },
}
