-- SPDX-License-Identifier: MIT-0
-- Planar arms of SBPL's benchmarks, with 6 and 20 links, on grids of cells.
--
--   trellis run examples/real/sbpl.lua --jobs 2
--
-- The goal of each is a cell for the end of the last link: when Trellis reads the file, inverse kinematics computes ten
-- configurations in it, each of which is a goal. Links that are not neighbours must not touch.

local problems = {}
for _, name in ipairs { "env1_6d", "env3_6d", "env1_20d" } do
  for _, problem in ipairs(scenes.load("sbpl/robarm/" .. name .. ".cfg", { resolution = 0.5 })) do
    problems[#problems + 1] = problem
  end
end

-- A longer step than a fifth of a radian passes few of the windows of env3_6d.
local planner = rrt_connect { step = 0.2, proposals = 500000 }

return experiment {
  problems   = problems,
  strategies = {
    rrt_connect = planner,
    joints      = joints { first = 4, planner = planner } >> planner,
    lazy        = lazy { planner = lazy_prm { proposals = 1000 } } >> rrt { step = 0.5 },
  },
  seeds   = 3,
  measure = false,
}
