-- SPDX-License-Identifier: MIT-0
-- The smallest experiment: a strategy and a problem.
--
--   trellis run examples/minimal.lua
--   trellis run examples/minimal.lua --seeds 10
--
-- A planner is a strategy by itself. `goal_bias(0.1) >> rrt {}` would be one with a guide.

return rrt { step = 0.5 }, scenes.cup()
