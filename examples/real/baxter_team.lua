-- SPDX-License-Identifier: MIT-0
-- Baxter's two arms as a team of two robots: robot 1 is the right arm, robot 2 the left one. The problems are those of
-- baxter.lua that its tables leave out.
--
--   tar xjf $TRELLIS_SCENES/vamp_mbm/baxter_problems_sixth.tar.bz2 -C examples/real
--   trellis run examples/real/baxter_team.lua --jobs 2
--
-- docs/teams.md has the table, by bench_arms --hard.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/baxter/"
local baxter = robot.urdf(folder .. "baxter_spherized.urdf", { srdf = folder .. "baxter.srdf", group = "both_arms" })
local scenarios = {}
for i, level in ipairs { "easy", "medium", "hard" } do scenarios[i] = "bookshelf_tall_both_arms_" .. level end

local planner = rrt_connect { step = 1, proposals = 10000000, seconds = 20, bound = 4 }
local inner = rrt_connect { step = 1 }
local left = team { robots = { "2" }, planner = inner }

return experiment {
  problems   = bench.problems(baxter, "baxter", scenarios, function(i) return i % 30 == 1 end),
  strategies = {
    { "rrt_connect",  planner },
    { "team",         left >> planner },
    { "hand >> team", workspace { point = "left_hand" } >> left >> planner },
    { "prioritise",   prioritise { planner = inner } >> planner },
    { "couple",       couple { planner = inner } >> planner },
    { "joined",       couple { where = "path", planner = inner } >> planner },
  },
  seeds   = 1,
  measure = false,
}
