-- SPDX-License-Identifier: MIT-0
-- Baxter's two arms, fourteen joints, as balls, on MotionBenchMaker's problems of a tall bookshelf: the workspace of a
-- hand guides one arm without the other, and that arm guides both; each level is left out in turn. couple plans each
-- arm alone, and then when it goes. Problems whose numbers are one more than a multiple of 30 are left out: the
-- strategies were chosen on them.
--
--   tar xjf $TRELLIS_SCENES/vamp_mbm/baxter_problems_sixth.tar.bz2 -C examples/real
--   trellis run examples/real/baxter.lua --jobs 2
--
-- docs/arms.md has the tables, by bench_arms --hard. baxter_alone.lua has all problems, without guides.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/baxter/"
local baxter = robot.urdf(folder .. "baxter_spherized.urdf", { srdf = folder .. "baxter.srdf", group = "both_arms" })
local scenarios = {}
for i, level in ipairs { "easy", "medium", "hard" } do scenarios[i] = "bookshelf_tall_both_arms_" .. level end

local function within(bound) return rrt_connect { step = 1, proposals = 10000000, seconds = 20, bound = bound } end
local planner = within(4)
local left = { "left_s0", "left_s1", "left_e0", "left_e1", "left_w0", "left_w1", "left_w2" }
local hand = workspace { point = "left_hand" }
local arm = joints { axes = left }

return experiment {
  problems   = bench.problems(baxter, "baxter", scenarios, function(i) return i % 30 ~= 1 end),
  strategies = {
    { "rrt_connect", planner },
    { "hand >> arm", hand >> arm >> planner },
    { "arm",         arm >> planner },
    { "hand",        hand >> planner },
    { "couple",      couple { where = "path", planner = rrt_connect { step = 1 } } >> within(8) },
  },
  seeds   = 1,
  measure = false,
}
