-- SPDX-License-Identifier: MIT-0
-- Fetch's arm with its torso, eight joints, as balls, on MotionBenchMaker's problems: which guides pay?
--
--   tar xjf $TRELLIS_SCENES/vamp_mbm/fetch_problems_odd.tar.bz2 -C examples/real
--   trellis run examples/real/fetch.lua --jobs 2
--
-- docs/arms.md has the tables, by bench_arms.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })

local planner = rrt_connect { step = 1, proposals = 10000000, seconds = 10 }

return experiment {
  problems   = bench.problems(fetch, "fetch", bench.scenarios, function(i) return i % 10 == 1 end),
  strategies = {
    { "rrt_connect", planner },
    { "workspace",   workspace { point = "gripper_link" } >> planner },
    { "skeleton",    skeleton { point = "gripper_link" } >> planner },
    { "shrink",      shrink(0.5) >> planner },
    { "lazy",        lazy() >> planner },
  },
  seeds   = 1,
  measure = false,
}
