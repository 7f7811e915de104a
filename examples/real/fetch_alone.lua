-- SPDX-License-Identifier: MIT-0
-- All of MotionBenchMaker's problems for Fetch, without guides. fetch.lua says how to unpack them.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })

return experiment {
  problems   = bench.problems(fetch, "fetch", bench.scenarios),
  strategies = { rrt_connect = rrt_connect { step = 1, proposals = 10000000, seconds = 60 } },
  seeds      = 1,
  measure    = false,
}
