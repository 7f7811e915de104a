-- SPDX-License-Identifier: MIT-0
-- As correlation.lua, for the arms of arms.lua, which are fixed to their base, and over rrt_connect: within the budget
-- rrt alone solves 2 runs of 15.
--
--   trellis run examples/correlation_arms.lua --quiet --json arms.json
--   trellis report arms.json --report costs

local arms = require "arms"
local guides = require "pays.guides"

local problems = {}
for i, problem in ipairs(arms.problems) do problems[i] = problem end

return experiment {
  problems   = problems,
  strategies = guides.over("rrt_connect", rrt_connect, { step = 0.3, proposals = 20000 }, "arms"),
  baseline   = "rrt_connect",
  seeds      = 5,
  measure    = tube { delta = 0.5 },
  ablation   = 0,
}
