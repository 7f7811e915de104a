-- SPDX-License-Identifier: MIT-0
-- Fetch's arm with its torso, eight joints, as balls, on MotionBenchMaker's problems: what does a guide through the
-- gripper save? Problems whose numbers end with 1 are left out: the guide's defaults were chosen on them.
--
--   tar xjf $TRELLIS_SCENES/vamp_mbm/fetch_problems_odd.tar.bz2 -C examples/real
--   trellis run examples/real/fetch.lua --jobs 2
--
-- docs/arms.md has the tables, by bench_arms. fetch_levels.lua has more guides.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })

local function planner(bound)
  return rrt_connect { step = 1, proposals = 10000000, seconds = 10, bound = bound }
end

return experiment {
  problems   = bench.problems(fetch, "fetch", bench.scenarios, function(i) return i % 10 ~= 1 end),
  strategies = {
    { "rrt_connect", planner(2) },
    { "workspace",   workspace { point = "gripper_link" } >> planner(2) },
    { "bound = 4",   workspace { point = "gripper_link" } >> planner(4) },
  },
  seeds   = 1,
  measure = false,
}
