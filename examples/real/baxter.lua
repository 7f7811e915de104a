-- SPDX-License-Identifier: MIT-0
-- Baxter's two arms, fourteen joints, as balls, on MotionBenchMaker's problems of a tall bookshelf.
--
--   tar xjf $TRELLIS_SCENES/vamp_mbm/baxter_problems_sixth.tar.bz2 -C examples/real
--   trellis run examples/real/baxter.lua --jobs 2
--
-- docs/arms.md has the tables, by bench_arms.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/baxter/"
local baxter = robot.urdf(folder .. "baxter_spherized.urdf", { srdf = folder .. "baxter.srdf", group = "both_arms" })
local levels = { "easy", "medium", "hard" }
local scenarios = {}
for i, level in ipairs(levels) do scenarios[i] = "bookshelf_tall_both_arms_" .. level end

local planner = rrt_connect { step = 1, proposals = 10000000, seconds = 10 }
local left = { "left_s0", "left_s1", "left_e0", "left_e1", "left_w0", "left_w1", "left_w2" }

return experiment {
  problems   = bench.problems(baxter, "baxter", scenarios),
  strategies = {
    { "rrt_connect", planner },
    { "left hand",   workspace { point = "left_hand" } >> planner },
    { "left arm",    joints(left) >> planner },
  },
  seeds   = 1,
  measure = false,
}
