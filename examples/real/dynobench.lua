-- SPDX-License-Identifier: MIT-0
-- Kinodynamic planning in scenes of dynobench: unicycles of first and second order and a car with a trailer, with the
-- motion models that the files name. dynobench_geometry.lua beside this plans for the geometry only. The unicycle of
-- unicycle1_v1/kink_0 can neither stop nor reverse, and has to turn in a pocket: curves succeed, random controls fail.
--
--   trellis run examples/real/dynobench.lua --jobs 2

local names = {
  "unicycle1_v0/bugtrap_0",
  "unicycle1_v0/parallelpark_0",
  "unicycle1_v1/kink_0",
  "unicycle2_v0/kink_0",
  "car1_v0/parallelpark_0",
  "car1_v0/kink_0",
}

local problems = {}
for _, name in ipairs(names) do
  -- A file may contain several problems: load returns a list, and lists in the list are flattened.
  problems[#problems + 1] = scenes.load("dynobench/" .. name .. ".yaml")
end

return experiment {
  problems   = problems,
  strategies = {
    { "unguided",      kinodynamic_rrt {} },
    { "holonomic",     holonomic() >> kinodynamic_rrt {} },
    { "decomposition", decomposition() >> kinodynamic_rrt {} },
    { "nested",        skeleton() >> holonomic() >> kinodynamic_rrt {} },
    { "curves",        decomposition() >> kinodynamic_rrt { extend = "curves", longest = 15 } },
  },
  seeds = 3,
}
