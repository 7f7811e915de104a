-- SPDX-License-Identifier: MIT-0
-- A UR5 with a gripper, six joints, as balls, on MotionBenchMaker's problems.
--
--   tar xjf $TRELLIS_SCENES/vamp_mbm/ur5_problems.tar.bz2 -C examples/real
--   trellis run examples/real/ur5.lua --jobs 2

local bench = require "motion_bench"
local folder = "vamp_mbm/robots/ur5/"
local ur5 = robot.urdf(folder .. "ur5_spherized.urdf", { srdf = folder .. "ur5.srdf", group = "manipulator" })

return experiment {
  problems   = bench.problems(ur5, "ur5", bench.scenarios),
  strategies = { rrt_connect = rrt_connect { step = 1, proposals = 10000000, seconds = 10 } },
  seeds      = 1,
  measure    = false,
}
