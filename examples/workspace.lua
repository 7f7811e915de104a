-- SPDX-License-Identifier: GPL-3.0-or-later
-- The robot as a free point: its way through the workspace tells where the robot should be, and not how it is turned.
--
--   trellis run examples/workspace.lua
--
-- On a grid the way is the shortest (A*), and only what the search comes to is checked. Any planner can search S.

return experiment {
  problems   = { scenes.cup(), scenes.simple_passage() },
  strategies = {
    { "rrt",       rrt { step = 0.5 } },
    { "grid",      workspace() >> rrt { step = 0.5 } },
    { "fine grid", workspace(0.1) >> rrt { step = 0.5 } },
    { "tree",      workspace { planner = rrt_connect { step = 0.5 } } >> rrt { step = 0.5 } },
    -- the point's way, then a robot of half the size
    { "nested",    workspace() >> shrink(0.5) >> rrt { step = 0.5 } },
  },
  seeds   = 3,
  measure = tube { delta = 0.5 },
}
