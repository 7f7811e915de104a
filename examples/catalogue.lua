-- SPDX-License-Identifier: MIT-0
-- Every guiding space, alone with an RRT on one scene: the report shows which of them save checks here.
--
--   trellis run examples/catalogue.lua
--
-- docs/catalogue.md describes f and h of each. experience() and path_database() require stored paths, and learned() a
-- trained model: docs/experience.md.

local tree = rrt { step = 0.5 }

-- A user-defined guide: the robot at two thirds of its size.
local smaller = guiding_space {
  name = "smaller",
  robot = function(instance) return instance.robot:scaled(2 / 3) end,
}

return experiment {
  problems   = { scenes.simple_passage() },
  strategies = {
    { "unguided",    tree },
    -- robot modification
    { "shrink",      shrink(0.5) >> tree },
    { "workspace",   workspace() >> tree },
    { "skeleton",    skeleton() >> tree },
    { "decomposition", decomposition() >> tree },
    { "holonomic",   holonomic() >> tree },
    { "blossom",     blossom() >> tree },
    { "joints",      joints { "x", "y" } >> tree },
    { "pca",         pca(2) >> tree },
    -- environment modification
    { "widen",       widen(0.15) >> tree },
    { "lazy",        lazy() >> tree },
    { "drop",        drop() >> tree },
    { "aggregate",   aggregate() >> tree },
    -- experience
    { "experience",  experience() >> tree },
    { "path_database", path_database() >> tree },
    { "learned",     learned() >> tree },
    -- S = C
    { "identity",    identity() >> tree },
    -- sampling, S = {0}
    { "uniform",     uniform() >> tree },
    { "goal_bias",   goal_bias(0.3) >> tree },
    { "gaussian",    gaussian(0.3) >> tree },
    { "bridge_test", bridge_test(0.6) >> tree },
    { "obstacle_based", obstacle_based() >> tree },
    { "medial_axis", medial_axis() >> tree },
    { "halton",      halton() >> tree },
    { "informed",    informed { cost = 13 } >> tree },
    { "information_gain", information_gain() >> tree },
    { "state_cells", state_cells() >> tree },
    -- combinators
    { "nesting",     skeleton() >> shrink(0.5) >> tree },
    { "mixture",     (0.5 * skeleton() + 0.5 * shrink(0.5)) >> tree },
    { "sequence",    (skeleton() .. shrink(0.5)) >> tree },
    { "blend",       blend { skeleton(), shrink(0.5) } >> tree },
    { "schedule",    schedule { shrink(0.4), shrink(0.8) } >> tree },
    { "race",        race { skeleton(), shrink(0.5) } >> tree },
    { "split",       shrink(0.5) >> split { tree } },
    -- user-defined
    { "guiding_space", smaller >> tree },
  },
  seeds   = 3,
  measure = tube { delta = 0.5 },
}
