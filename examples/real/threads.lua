-- SPDX-License-Identifier: MIT-0
-- One run on many cores: MotionBenchMaker's problems for Fetch whose numbers end with 1, without a guide and with one.
-- fetch.lua says how to unpack them.
--
--   trellis run examples/real/threads.lua --ablation 0 --threads 4

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })
local planner = rrt_connect { step = 1, grow = "in_turn", proposals = 10000000, seconds = 60 }
local thin = shrink { scale = 0.8, planner = rrt_connect { step = 1, grow = "in_turn" } }

return experiment {
  problems   = bench.problems(fetch, "fetch", bench.scenarios, function(i) return i % 10 == 1 end),
  strategies = { rrt_connect = planner, shrink = thin >> planner },
  seeds      = 1,
  measure    = false,
}
