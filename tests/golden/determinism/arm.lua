-- SPDX-License-Identifier: GPL-3.0-or-later
-- An arm, for the hashes of whole runs (tests/cli/determinism.cpp).
local tree = rrt { step = 0.1, proposals = 4000 }

return experiment {
  problems = problem {
    name = "arm",
    robot = robot.arm { links = {2.4, 2}, width = 0.25, base = {5, 5} },
    world = world { bounds = {0, 0, 10, 10}, box {6.2, 7, 8.2, 8.2}, disc {7.4, 2.9, 0.6} },
    start = {1.9, 0.4}, goal = {-0.9, -0.5}, resolution = 0.02,
  },
  seeds      = 2,
  measure    = false,
  strategies = {
    { "rrt",         tree },
    { "rrt_connect", rrt_connect { proposals = 4000 } },
    { "lazy",        lazy() >> tree },
    { "joints",      joints { first = 1 } >> tree },
    { "skeleton",    skeleton() >> tree },
    { "workspace",   workspace() >> tree },
  },
}
