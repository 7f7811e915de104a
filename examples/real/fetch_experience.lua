-- SPDX-License-Identifier: MIT-0
-- Do paths of solved problems help with others of the same scenarios? fetch_learn.lua makes the library; here are the
-- problems whose numbers end with 5, 7 or 9. docs/arms.md has the table, by bench_arms --hard.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })

local function planner(bound)
  return rrt_connect { step = 1, proposals = 10000000, seconds = 20, bound = bound }
end

return experiment {
  problems   = bench.problems(fetch, "fetch", bench.scenarios, function(i) return i % 10 >= 5 end),
  strategies = {
    { "rrt_connect", planner(2) },
    { "experience",  experience { db = "fetch.db" } >> planner(2) },
    { "bound = 4",   experience { db = "fetch.db" } >> planner(4) },
  },
  seeds   = 1,
  measure = false,
}
