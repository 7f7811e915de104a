-- SPDX-License-Identifier: GPL-3.0-or-later
-- Every guiding space that there is, alone with an RRT on one scene: which of them help here, and at what cost.
--
--   trellis run examples/catalogue.lua
--
-- docs/catalogue.md says what f and h of each are.

local tree = rrt { step = 0.5 }

return experiment {
  problems   = { scenes.simple_passage() },
  strategies = {
    { "unguided",    tree },
    -- robot modification
    { "shrink",      shrink(0.5) >> tree },
    { "skeleton",    skeleton() >> tree },
    -- environment modification
    { "lazy",        lazy() >> tree },
    -- S = C
    { "identity",    identity() >> tree },
    -- sampling, S = {0}
    { "uniform",     uniform() >> tree },
    { "goal_bias",   goal_bias(0.3) >> tree },
    { "gaussian",    gaussian(0.3) >> tree },
    { "bridge_test", bridge_test(0.6) >> tree },
    -- combinators
    { "nesting",     skeleton() >> shrink(0.5) >> tree },
    { "mixture",     (0.5 * skeleton() + 0.5 * shrink(0.5)) >> tree },
    { "sequence",    (skeleton() .. shrink(0.5)) >> tree },
    { "blend",       blend { skeleton(), shrink(0.5) } >> tree },
  },
  seeds   = 3,
  measure = tube { delta = 0.5 },
}
