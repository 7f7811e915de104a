-- SPDX-License-Identifier: MIT-0
-- A Panda arm with seven joints, as balls, on MotionBenchMaker's problems.
--
--   trellis run examples/real/panda.lua                      one problem of each scenario
--   tar xjf $TRELLIS_SCENES/vamp_mbm/panda_problems_odd.tar.bz2 -C examples/real
--   trellis run examples/real/panda.lua                      all 349 problems whose ends are valid
--
-- RRT-Connect needs about a hundred proposals, so no guide can pay here; fetch.lua has the problems where one may.

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/panda/"
local panda = robot.urdf(folder .. "panda_spherized.urdf", { srdf = folder .. "panda.srdf", group = "panda_arm" })

local problems = bench.found(panda, "panda", bench.scenarios)
if #problems == 0 then
  for _, scenario in ipairs(bench.scenarios) do
    local file = "vamp_mbm/panda_samples/" .. scenario .. "_scene0001.yaml"
    problems[#problems + 1] = scenes.load(file, { robot = panda, name = scenario .. "/0001" })[1]
  end
end

return experiment {
  problems   = problems,
  strategies = { rrt_connect = rrt_connect { step = 1 } },
  seeds      = 1,
  measure    = false,
}
