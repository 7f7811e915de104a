-- SPDX-License-Identifier: MIT-0
-- A hook that has to turn through two walls: an environment of Parasol's planning library (PPL), with its query.
--
--   trellis run examples/real/hook.lua
--
-- The world is 600 units long, so checks are a unit apart, and a turn by a radian counts as 40 units of the metric. The
-- holes are as wide as the hook's bars. A path of maximal balls leads straight through them and saves two thirds of the
-- checks; one on a grid saves a quarter, and a smaller hook below either costs more than it saves.

local query = scenes.load("open_ppl/hook/hook.env", { resolution = 1, weight = 40 })
local planner = rrt_connect { step = 20, proposals = 1000000 }

return experiment {
  problems   = query,
  strategies = {
    { "rrt_connect",        planner },
    { "shrink",             shrink(0.7) >> planner },
    { "skeleton",           skeleton() >> planner },
    { "skeleton >> shrink", skeleton() >> shrink(0.7) >> planner },
    { "workspace",          workspace() >> planner },
    { "nested",             workspace() >> shrink(0.7) >> planner },
  },
  seeds   = 3,
  measure = tube { delta = 20 },
}
