-- SPDX-License-Identifier: MIT-0
-- All of MotionBenchMaker's problems for Baxter's two arms, without guides. baxter.lua says how to unpack them.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/baxter/"
local baxter = robot.urdf(folder .. "baxter_spherized.urdf", { srdf = folder .. "baxter.srdf", group = "both_arms" })
local scenarios = {}
for i, level in ipairs { "easy", "medium", "hard" } do scenarios[i] = "bookshelf_tall_both_arms_" .. level end

return experiment {
  problems   = bench.problems(baxter, "baxter", scenarios),
  strategies = { rrt_connect = rrt_connect { step = 1, proposals = 10000000, seconds = 10 } },
  seeds      = 1,
  measure    = false,
}
