-- SPDX-License-Identifier: MIT-0
-- Guides in Lua that see the world: shapes have bounds and vertices, and the instance answers questions about
-- configurations. See docs/guiding_space.md.
--
--   trellis run examples/obstacles.lua

-- Draws near the corners of obstacles, where shortest paths turn: beside each corner, away from the obstacle's middle,
-- as far as the robot reaches. S = {0}.
local corners = guiding_space {
  name = "corners",
  space = {},
  heuristic = function(_, instance)
    local lower, upper = instance.space.lower, instance.space.upper
    local reach = instance.robot.bounding_radius
    local beside = {}
    for _, shape in ipairs(instance.world.obstacles) do
      local bounds = shape.bounds
      local middle = { (bounds[1] + bounds[3]) / 2, (bounds[2] + bounds[4]) / 2 }
      for _, corner in ipairs(shape.kind == "disc" and {} or shape.vertices) do
        local dx, dy = corner[1] - middle[1], corner[2] - middle[2]
        local scale = reach / math.sqrt(dx * dx + dy * dy)
        local q = { corner[1] + scale * dx, corner[2] + scale * dy, 0 }
        if instance:clearance(q) > 0 then beside[#beside + 1] = q end
      end
    end
    local function within(i, x) return math.min(upper[i], math.max(lower[i], x)) end
    return function(random, normal)
      local q = beside[1 + math.floor(random() * #beside)]
      return within(1, q[1] + reach * normal()), within(2, q[2] + reach * normal()), 2 * math.pi * random()
    end
  end,
}

-- Draws uniformly, and moves what is near an obstacle away from the obstacle's nearest point. S = {0}.
local away = guiding_space {
  name = "away",
  space = {},
  heuristic = function(_, instance)
    local lower, upper = instance.space.lower, instance.space.upper
    local reach = instance.robot.bounding_radius
    local function uniform_on(i, random) return lower[i] + random() * (upper[i] - lower[i]) end
    local function within(i, x) return math.min(upper[i], math.max(lower[i], x)) end
    return function(random)
      local x, y, angle = uniform_on(1, random), uniform_on(2, random), uniform_on(3, random)
      local near = instance:nearest_obstacle(x, y, angle)
      if near and near.point and near.distance < reach then
        local dx, dy = x - near.point[1], y - near.point[2]
        local scale = (reach - near.distance) / math.sqrt(dx * dx + dy * dy)
        x, y = within(1, x + scale * dx), within(2, y + scale * dy)
      end
      return x, y, angle
    end
  end,
}

return experiment {
  problems   = { scenes.simple_passage() },
  strategies = {
    { "rrt", rrt { step = 0.5 } },
    { "corners", corners >> rrt { step = 0.5 } },
    { "away", away >> rrt { step = 0.5 } },
  },
  seeds      = 15,
  measure    = false,
}
