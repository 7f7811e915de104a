-- SPDX-License-Identifier: MIT-0
-- Which guides pay for Fetch, alone and together? On problems that fetch.lua leaves out.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })
local planner = rrt_connect { step = 1, proposals = 10000000, seconds = 6, bound = 4 }
local hand = workspace { point = "gripper_link" }
local hard = { "bookshelf_small", "bookshelf_tall", "bookshelf_thin", "cage" }

-- The first joints, from the torso on, with what they move of the arm.
local function first(n) return joints { first = n } end

return experiment {
  problems   = bench.problems(fetch, "fetch", hard, function(i) return i % 10 == 1 end),
  strategies = {
    { "rrt_connect",             planner },
    { "workspace",               hand >> planner },
    { "joints 4",                first(4) >> planner },
    { "joints 5",                first(5) >> planner },
    { "joints 6",                first(6) >> planner },
    { "joints 7",                first(7) >> planner },
    { "shrink",                  shrink(0.5) >> planner },
    { "lazy",                    lazy() >> planner },
    { "pca",                     pca {} >> planner },
    { "workspace >> joints 6",   hand >> first(6) >> planner },
    { "workspace >> shrink",     hand >> shrink(0.8) >> planner },
    { "workspace >> lazy",       hand >> lazy() >> planner },
    { "workspace + joints 6",    (hand + first(6)) >> planner },
    { "workspace + joints 7",    (hand + first(7)) >> planner },
    { "blend, joints 6",         blend { hand, first(6) } >> planner },
    { "blend, joints 6, shrink", blend { hand, first(6), shrink(0.5) } >> planner },
  },
  seeds   = 1,
  measure = false,
}
