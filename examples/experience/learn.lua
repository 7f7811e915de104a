-- SPDX-License-Identifier: GPL-3.0-or-later
-- What is learnt before: two ways in a world with two walls, whose paths go into a library of solved problems.
--
--   trellis run examples/experience/learn.lua --learn examples/experience/paths.db
--   trellis experience examples/experience/paths.db
--   trellis run examples/experience/use.lua
--
-- `--learn` adds the paths that were found to the library, which is made where there is none. Of the ten runs only
-- those add one whose path differs from all that are there. use.lua goes by them.

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
