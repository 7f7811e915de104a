-- SPDX-License-Identifier: MIT-0
-- Which further level pays above or beside a guide through the gripper of Fetch? fetch.lua says what is needed.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })
local planner = rrt_connect { step = 1, proposals = 10000000, seconds = 6 }
local hand = workspace { point = "gripper_link" }
local hard = { "bookshelf_small", "bookshelf_tall", "bookshelf_thin", "cage" }

return experiment {
  problems   = bench.problems(fetch, "fetch", hard, function(i) return i % 10 == 1 end),
  strategies = {
    { "rrt_connect",              planner },
    { "workspace",                hand >> planner },
    { "workspace >> shrink",      hand >> shrink(0.8) >> planner },
    { "workspace >> lazy",        hand >> lazy() >> planner },
    { "workspace + shrink",       (hand + shrink(0.5)) >> planner },
    { "workspace + halton",       (hand + halton()) >> planner },
    { "workspace, hand + forearm", (hand + workspace { point = "forearm_roll_link" }) >> planner },
    { "forearm",                  workspace { point = "forearm_roll_link" } >> planner },
    { "skeleton",                 skeleton { point = "gripper_link" } >> planner },
    { "shrink",                   shrink(0.5) >> planner },
    { "lazy",                     lazy() >> planner },
    { "joints",                   joints { first = 4 } >> planner },
    { "pca",                      pca {} >> planner },
  },
  seeds   = 1,
  measure = false,
}
