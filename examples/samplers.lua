-- SPDX-License-Identifier: MIT-0
-- Biases without a space (S = {0}), each as the only guide of an RRT.
--
--   trellis run examples/samplers.lua
--
-- The configurations that they check to find a sample (pairs, bridges, rays) cost validity checks, which the table
-- counts. None of them makes progress along a path, so bounded loss leaves them about half of the work; the rest
-- stays uniform.

local samplers = {
  uniform     = uniform(),
  goal_bias   = goal_bias(0.3),
  gaussian    = gaussian(0.3),
  bridge_test = bridge_test(0.6),
  obstacle_based = obstacle_based(),
  medial_axis = medial_axis(),
  halton = halton(),
  -- where the validity of C is known least
  information_gain = information_gain(),
  -- one node in each cell of a grid; names the node to extend
  state_cells = state_cells(),
  -- states that a path shorter than 13 m may visit
  informed = informed { cost = 13 },
}

local strategies = {}
for name, guide in pairs(samplers) do strategies[name] = guide >> rrt { step = 0.5 } end
-- An anytime search reports each path length to it: here those of S, once the tree in C makes no progress.
strategies.shorter = informed() >> identity { planner = rrt { step = 0.5 }, evidence = 20 } >> rrt { step = 0.5 }

return experiment {
  problems   = { scenes.simple_passage() },
  strategies = strategies,
  seeds      = 3,
  measure    = tube { delta = 0.5 },
}
