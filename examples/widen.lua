-- SPDX-License-Identifier: MIT-0
-- Eroded obstacles, so that a narrow passage is wide in S: the guide finds a path through it there, and C follows it.
--
--   trellis run examples/widen.lua
--
-- It erodes each obstacle separately. Walls less than twice as thick as the distance vanish, and the path through them
-- misleads: this happens in the cup, whose walls are 0.5 thick.

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
