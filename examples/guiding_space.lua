-- SPDX-License-Identifier: MIT-0
-- User-defined guiding spaces: f and h in Lua, composed like built-in ones. See docs/guiding_space.md.

-- As the built-in shrink { 0.5, follow = "tube", resolves = 0 }: the robot at half its size in the same world.
local half = guiding_space {
  name = "half",
  robot = function(instance) return instance.robot:scaled(0.5) end,
  heuristic = function(found) return along(found.path, { follow = "tube" }) end,
  resolves = 0,
}

-- As the built-in workspace(), with rrt {} in place of the grid: the robot as a free point in the workspace. S has
-- two of C's axes; the third, the angle, is lifted uniformly.
local point = guiding_space {
  name = "point",
  space = { "x", "y" },
  robot = robot.point(),
  heuristic = function(found) return lifted(along(found.path, { radius = 0.5 })) end,
}

-- A bias without a space: S = {0}. Samples the straight line from start to goal, with a normal offset on each axis; its
-- density has no closed form.
local straight = guiding_space {
  name = "straight",
  space = {},
  heuristic = function(_, instance)
    local lower, upper = instance.space.lower, instance.space.upper
    local from, to = instance.start, instance.goal
    local function near(i, t, normal)
      return math.min(upper[i], math.max(lower[i], from[i] + t * (to[i] - from[i]) + normal()))
    end
    return function(random, normal)
      local t = random()
      return near(1, t, normal), near(2, t, normal), from[3] + t * (to[3] - from[3]) + normal()
    end
  end,
}

-- Without the planner's own search beside the guided one: the figures are those of the guides.
local guided = rrt { step = 0.5, bound = 0 }

return experiment {
  problems   = { scenes.simple_passage() },
  strategies = {
    { "rrt", rrt { step = 0.5 } },
    { "shrink", shrink { 0.5, follow = "tube", resolution = 0.05, resolves = 0 } >> guided },
    { "half", half >> guided },
    { "workspace", workspace { radius = 0.5, planner = rrt {} } >> guided },
    { "point", point >> guided },
    { "all", (0.8 * (point >> half) + 0.2 * straight) >> lazy() >> guided },
  },
  seeds      = 15,
  measure    = tube { delta = 0.5 },
}
