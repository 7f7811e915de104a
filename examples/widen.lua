-- SPDX-License-Identifier: GPL-3.0-or-later
-- Obstacles eroded, so that a narrow passage is a wide one in S: the path through it is found there, and followed in C.
--
--   trellis run examples/widen.lua
--
-- Each obstacle is eroded by itself. Walls less than twice as thick as the distance vanish, and the path found
-- through them misleads: that is the cup, whose walls are 0.5 thick.

return experiment {
  problems   = { scenes.simple_passage(), scenes.cup() },
  strategies = {
    { "rrt",     rrt { step = 0.5 } },
    { "widen",   widen(0.15) >> rrt { step = 0.5 } },
    { "too far", widen(0.3) >> rrt { step = 0.5 } },
    -- the same, wide at first and then less so
    { "staged",  widen(0.2) >> widen(0.1) >> rrt { step = 0.5 } },
  },
  seeds   = 3,
  measure = tube { delta = 0.5 },
}
