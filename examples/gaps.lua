-- SPDX-License-Identifier: MIT-0
-- Skeletons feeding lazy checks: a hierarchy of which each level pays.
--
--   trellis run examples/gaps.lua
--
-- Four walls have eight gaps each: most are too narrow for the robot, or so bent that it cannot turn in them. Read
-- `>>` as "guides". The tree of the RRT at the right end grows in the robot's own configuration space; each guide to
-- its left searches a simpler space, and proposals to its right follow the path found there:
--
--   skeleton()    the medial axis of the free workspace: where it is wide enough for the robot
--   lazy()        the world without obstacles; the motions of its path are checked for the robot, each once, and a path
--                 through a bent gap is refuted
--
-- The report says whether each level pays: the cost of the strategy beside its cost without that level, on the same
-- seeds. nested.lua has a hierarchy of three guides.

local nested = skeleton() >> lazy() >> rrt { step = 0.5 }

return experiment {
  problems   = { worlds.false_gaps { rows = 4, gaps = 8, kind = "mixed", seed = 2 } },
  strategies = { rrt_connect = rrt_connect { step = 0.5 }, nested = nested },
  baseline   = "rrt_connect",
  seeds      = 15,
  measure    = tube { delta = 0.5 },
}
