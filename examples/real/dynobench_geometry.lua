-- SPDX-License-Identifier: MIT-0
-- Scenes of dynobench: unicycles, a car with a trailer and a planar rotorcraft among boxes. This script plans for their
-- geometry; dynobench.lua beside it plans with their motion models.
--
--   trellis run examples/real/dynobench_geometry.lua --jobs 2

local names = {
  "car1_v0/kink_0",
  "car1_v0/parallelpark_0",
  "quad2d_v0/quad2d_recovery_obs",
  "quad2d_v0/quad_obs_column",
  "unicycle1_v0/bugtrap_0",
  "unicycle1_v0/parallelpark_0",
  "unicycle1_v1/kink_0",
  "unicycle2_v0/kink_0",
}

local problems = {}
for _, name in ipairs(names) do
  -- A file may contain several problems: load returns a list, and lists in the list are flattened.
  problems[#problems + 1] = scenes.load("dynobench/" .. name .. ".yaml", { motion = false })
end

return experiment {
  problems   = problems,
  strategies = {
    rrt    = rrt { step = 0.3 },
    nested = skeleton() >> shrink(0.5) >> lazy() >> rrt { step = 0.3 },
  },
  seeds   = 3,
  measure = tube { delta = 0.3 },
}
