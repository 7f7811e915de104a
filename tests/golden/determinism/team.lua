-- SPDX-License-Identifier: GPL-3.0-or-later
-- A team of discs that change places beside a wall, for the hashes of whole runs (tests/cli/determinism.cpp).
local planner = rrt_connect { proposals = 4000, bound = 0 }

return experiment {
  problems = problem {
    name = "team",
    robot = robots { robot.disc(0.4), count = 4 },
    world = world { bounds = {0, 0, 10, 10}, box {4, 0, 5, 6} },
    start = { {1, 1}, {8, 1}, {1, 3}, {8, 3} }, goal = { {8, 1}, {1, 1}, {8, 3}, {1, 3} },
  },
  seeds      = 2,
  measure    = false,
  strategies = {
    { "rrt_connect", rrt_connect { proposals = 4000 } },
    { "drrt",        drrt { proposals = 2000 } },
    { "team",        team { 1, 2 } >> planner },
    { "decouple",    decouple { tries = 2, effort = 500 } >> planner },
    { "prioritise",  prioritise() >> planner },
    { "couple",      couple() >> planner },
    { "skeletons",   skeleton() >> prioritise() >> planner },
  },
}
