-- SPDX-License-Identifier: MIT-0
-- The robot as a free point: its path through the workspace guides the robot's position, but not its angle.
--
--   trellis run examples/workspace.lua
--
-- On a grid the path is the shortest (A*), and the search checks only cells that it reaches. Any planner can search S.

return experiment {
  problems   = { scenes.cup(), scenes.simple_passage() },
  strategies = {
    { "rrt",       rrt { step = 0.5 } },
    { "grid",      workspace() >> rrt { step = 0.5 } },
    { "fine grid", workspace(0.1) >> rrt { step = 0.5 } },
    { "tree",      workspace { planner = rrt_connect { step = 0.5 } } >> rrt { step = 0.5 } },
    -- the point's path, then a robot of half the size
    { "nested",    workspace() >> shrink(0.5) >> rrt { step = 0.5 } },
  },
  seeds   = 3,
  measure = tube { delta = 0.5 },
}
