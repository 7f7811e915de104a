-- SPDX-License-Identifier: GPL-3.0-or-later
-- A robot of links and joints in space, for the hashes of whole runs (tests/cli/determinism.cpp).
local six = robot.urdf("six.urdf", { srdf = "six.srdf", group = "arm" })
local planner = rrt_connect { step = 0.5, proposals = 20000 }

return experiment {
  problems = problem {
    name = "manipulator", robot = six, start = "ready", goal = "aside", resolution = 0.02,
    world = world {
      bounds = {-2, -2, -2, 2, 2, 2}, contain = "none",
      sphere {0.5, 0.6, 0.7, 0.15}, box {-0.2, 0.7, 0.3, 0.2, 1.0, 0.8},
      cylinder { radius = 0.1, length = 0.6, pose = pose {0.6, 0.5, 0.3, rpy = {0.4, 0, 0}} },
      capsule { radius = 0.05, length = 0.4, pose = pose {0, 0.5, 1.1, rpy = {0, 1.2, 0}} },
    },
  },
  seeds      = 2,
  measure    = false,
  strategies = {
    { "rrt",         rrt { step = 0.5, proposals = 20000 } },
    { "rrt_connect", planner },
    { "shrink",      shrink(0.5) >> planner },
    { "lazy",        lazy() >> planner },
    { "joints",      joints { first = 3 } >> planner },
    { "workspace",   workspace { point = "tool" } >> rrt_connect { step = 0.5, proposals = 20000, bound = 0 } },
    { "skeleton",    skeleton { point = "tool" } >> rrt_connect { step = 0.5, proposals = 20000, bound = 0 } },
  },
}
