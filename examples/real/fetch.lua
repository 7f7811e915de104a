-- SPDX-License-Identifier: MIT-0
-- Fetch's arm with its torso, eight joints, as balls, on MotionBenchMaker's problems: what do guides save? One searches
-- the workspace of the gripper, one the first six joints, with what of the arm they move: without the wrist. Problems
-- whose numbers end with 1 or 3 are left out: the strategies were chosen on them.
--
--   tar xjf $TRELLIS_SCENES/vamp_mbm/fetch_problems_odd.tar.bz2 -C examples/real
--   trellis run examples/real/fetch.lua --jobs 2
--
-- docs/arms.md has the tables, by bench_arms. fetch_levels.lua has more guides.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })

local function planner(bound)
  return rrt_connect { step = 1, proposals = 10000000, seconds = 20, bound = bound }
end
local hand = workspace { point = "gripper_link" }
local arm = joints { first = 6 }

return experiment {
  problems   = bench.problems(fetch, "fetch", bench.scenarios, function(i) return i % 10 >= 5 end),
  strategies = {
    { "rrt_connect",  planner(2) },
    { "hand and arm", blend { hand, arm } >> planner(8) },
    { "hand",         hand >> planner(8) },
    { "arm",          arm >> planner(8) },
    { "bound = 4",    blend { hand, arm } >> planner(4) },
    { "bound = 2",    blend { hand, arm } >> planner(2) },
  },
  seeds   = 1,
  measure = false,
}
