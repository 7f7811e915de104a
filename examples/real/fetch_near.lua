-- SPDX-License-Identifier: MIT-0
-- How near must a stored path be to help? The problems whose paths are in the library of fetch_learn.lua; bench_arms
-- moves their goals. docs/arms.md has the table:
--
--   build/release/tests/bench/bench_arms examples/real/fetch_near.lua --hard --moved 0.5

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })
local planner = rrt_connect { step = 1, proposals = 10000000, seconds = 20, bound = 4 }

return experiment {
  problems   = bench.problems(fetch, "fetch", bench.scenarios, function(i) return i % 10 < 5 end),
  strategies = {
    { "rrt_connect", planner },
    { "experience",  experience { db = "fetch.db" } >> planner },
  },
  seeds   = 1,
  measure = false,
}
