-- SPDX-License-Identifier: GPL-3.0-or-later
-- What a Trellis script finds besides Lua, and what it does not find (dsl/lua/libraries.cpp leaves it out).
stds.trellis = {
  read_globals = {
    -- planners
    "rrt", "rrt_connect", "prm", "lazy_prm", "graph_search",
    -- guides
    "uniform", "goal_bias", "gaussian", "bridge_test", "identity", "skeleton", "shrink", "lazy", "blend", "sequence",
    -- problems
    "world", "robot", "box", "disc", "polygon", "problem",
    -- experiments
    "experiment", "tube", "near_optimal", "progress", "target",
    "exact", "knn", "kde", "histogram", "legacy", "ablations", "published", "claim",
    -- modules of the standard library
    "paper", "scenes", "strategies",
  },
}
std = "lua54+trellis"
not_globals = { "debug", "dofile", "io", "loadfile", "os", "package" }
max_line_length = 120
