-- SPDX-License-Identifier: MIT-0
-- Skeletons feeding shrunken robots feeding lazy checks: a hierarchy of guiding spaces, beside a plain RRT.
--
--   trellis run examples/nested.lua
--
-- Read `>>` as "guides". The tree of the RRT at the right end grows in the robot's own configuration space; each guide
-- to its left searches a simpler space, and proposals to its right follow the path found there:
--
--   skeleton()    the medial axis of the free workspace: where the workspace is wide enough
--   shrink(0.5)   the same world with a robot of half the size: which of these paths a robot can take
--   lazy()        the world without obstacles; the edges of its path are validated for the robot, each once
--
-- The report has a row for each level: its cost, and how well its samples predict where the final path lies (the
-- sampling efficiency, in nats above uniform sampling, more is better), in its own space and lifted to the robot's.

local nested = skeleton() >> shrink(0.5) >> lazy() >> rrt { step = 0.5 }

return experiment {
  problems   = { scenes.simple_passage() },
  strategies = { rrt = rrt { step = 0.5 }, nested = nested },
  seeds      = 15,
  measure    = tube { delta = 0.5 },
}
