-- SPDX-License-Identifier: MIT-0
-- The training runs: two paths in a world with two walls, which go into a library of solved problems.
--
--   trellis run examples/experience/learn.lua --learn examples/experience/paths.db
--   trellis experience examples/experience/paths.db
--   trellis run examples/experience/use.lua
--
-- `--learn` adds the paths of the runs to the library, and creates a missing file. Of the ten runs, only those whose
-- path differs from all stored paths add one. use.lua uses the library.

local walls = require "walls"
local arm = robot.rectangle(0.6, 0.2)

local function crossing(name, start, goal)
  return problem { name = name, world = walls(), robot = arm, start = start, goal = goal }
end

return experiment {
  problems = {
    crossing("to the middle", {1, 5, 0}, {5, 8.5, 0}),
    crossing("from the middle", {5, 8.5, 0}, {9, 5, 0}),
  },
  strategies = { connect = rrt_connect { step = 0.5 } },
  seeds = 5,
  shortcut = 200,
  measure = false,
}
