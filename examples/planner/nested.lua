-- SPDX-License-Identifier: MIT-0
-- The planner of main.cpp under guides, at the root and for the search of a level. Run it with my_trellis.
-- luacheck: read_globals sampled_rrt
local plain = sampled_rrt { step = 0.4 }
return experiment {
  problems = { scenes.simple_passage() },
  strategies = {
    plain = plain,
    nested = skeleton() >> shrink { 0.5, planner = sampled_rrt { candidates = 16 } } >> lazy() >> plain,
  },
  seeds = 10,
}
