-- SPDX-License-Identifier: GPL-3.0-or-later
-- Biases without a space behind them (S = {0}), each as the only guide of an RRT.
--
--   trellis run examples/samplers.lua
--
-- Each of them draws with nine of ten guided proposals; the rest stays uniform. What they look at to find a sample
-- (pairs, bridges) is paid in validity checks, which the table counts.

local samplers = {
  uniform     = uniform(),
  goal_bias   = goal_bias(0.3),
  gaussian    = gaussian(0.3),
  bridge_test = bridge_test(0.6),
}

local strategies = {}
for name, guide in pairs(samplers) do strategies[name] = guide >> rrt { step = 0.5 } end

return experiment {
  problems   = { scenes.simple_passage() },
  strategies = strategies,
  seeds      = 3,
  measure    = tube { delta = 0.5 },
}
