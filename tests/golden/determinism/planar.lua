-- SPDX-License-Identifier: GPL-3.0-or-later
-- Every guide and every planner of a rigid robot, for the hashes of whole runs (tests/cli/determinism.cpp).
local tree = rrt { step = 0.5, proposals = 4000 }

local smaller = guiding_space {
  name = "smaller",
  robot = function(instance) return instance.robot:scaled(2 / 3) end,
}

return experiment {
  problems   = { scenes.simple_passage() },
  seeds      = 2,
  measure    = false,
  strategies = {
    -- planners
    { "rrt",            tree },
    { "rrt_connect",    rrt_connect { proposals = 4000 } },
    { "prm",            prm { proposals = 1000 } },
    { "lazy_prm",       lazy_prm { proposals = 1000 } },
    { "rrt_star",       rrt_star { proposals = 1000 } },
    { "prm_star",       prm_star { proposals = 1000 } },
    { "lazy_prm_star",  lazy_prm_star { proposals = 1000 } },
    { "lazy_rrg_star",  lazy_rrg_star { proposals = 1000 } },
    { "graph_search",   workspace { planner = graph_search {} } >> tree },
    { "best_first",     workspace { planner = best_first {} } >> tree },
    { "best_first, learnt", workspace { planner = best_first { model = "searches.model" } } >> tree },
    -- guides
    { "shrink",         shrink(0.5) >> tree },
    { "workspace",      workspace() >> tree },
    { "skeleton",       skeleton() >> tree },
    { "skeleton, roadmap", skeleton() >> prm { proposals = 1000 } },
    { "decomposition",  decomposition() >> tree },
    { "joints",         joints { "x", "y" } >> tree },
    { "pca",            pca(2) >> tree },
    { "widen",          widen(0.15) >> tree },
    { "lazy",           lazy() >> tree },
    { "drop",           drop() >> tree },
    { "aggregate",      aggregate() >> tree },
    { "experience",     experience { db = "paths.db" } >> tree },
    { "path_database",  path_database { db = "paths.db" } >> tree },
    { "learned",        learned { model = "cells.model" } >> tree },
    { "identity",       identity() >> tree },
    { "uniform",        uniform() >> tree },
    { "goal_bias",      goal_bias(0.3) >> tree },
    { "gaussian",       gaussian(0.3) >> tree },
    { "bridge_test",    bridge_test(0.6) >> tree },
    { "obstacle_based", obstacle_based() >> tree },
    { "medial_axis",    medial_axis() >> tree },
    { "halton",         halton() >> tree },
    { "informed",       informed { cost = 13 } >> rrt_star { proposals = 1000 } },
    { "information_gain", information_gain() >> tree },
    { "state_cells",    state_cells() >> tree },
    -- combinators
    { "nesting",        skeleton() >> shrink(0.5) >> tree },
    { "mixture",        (0.5 * skeleton() + 0.5 * shrink(0.5)) >> tree },
    { "sequence",       (skeleton() .. shrink(0.5)) >> tree },
    { "blend",          blend { skeleton(), shrink(0.5) } >> tree },
    { "schedule",       schedule { shrink(0.4), shrink(0.8) } >> tree },
    { "race",           race { skeleton(), shrink(0.5) } >> tree },
    { "split",          shrink(0.5) >> split { tree } },
    { "guiding_space",  smaller >> tree },
  },
}
