-- SPDX-License-Identifier: MIT-0
-- Solves problems of Fetch whose numbers end with 1 or 3, for fetch_experience.lua.
--
--   cd examples/real; trellis run fetch_learn.lua --learn fetch.db

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })

return experiment {
  problems   = bench.problems(fetch, "fetch", bench.scenarios, function(i) return i % 10 < 5 end),
  strategies = { rrt_connect = rrt_connect { step = 1, proposals = 10000000, seconds = 10 } },
  seeds      = 1,
  measure    = false,
}
