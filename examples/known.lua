-- SPDX-License-Identifier: MIT-0
-- Guides whose spaces are built from what the search in C found. Functions with a second parameter, `known`, are called
-- again when the path is refuted, and when the guide's turn in a sequence comes. See docs/guiding_space.md.
--
--   trellis run examples/known.lua

-- A point among obstacles that grow where C failed: each motion that was blocked widens the obstacle next to it, up to
-- a tenth of a metre. So gaps that the point passes and the robot does not close one after another.
local widened = guiding_space {
  name = "widened",
  space = { "x", "y" },
  robot = robot.point(),
  resolves = 100,
  world = (function()
    local blocked = {}  -- how often, by the number of the obstacle
    return function(instance, known)
      for _, sample in ipairs(known.new) do
        local near = sample.blocked_at and instance:nearest_obstacle(sample.blocked_at)
        if near then blocked[near.number] = (blocked[near.number] or 0) + 1 end
      end
      local shapes = {}
      for number, shape in ipairs(instance.world.obstacles) do
        local b, margin = shape.bounds, math.min(0.1, 0.01 * (blocked[number] or 0))
        shapes[number] = box { b[1] - margin, b[2] - margin, b[3] + margin, b[4] + margin, name = shape.name }
      end
      return world { bounds = instance.world.bounds, shapes }
    end
  end)(),
  heuristic = function(found) return lifted(along(found.path, { radius = 0.3, evidence = 10 })) end,
}

-- A roadmap of spaces: a graph of the nodes that C has, each connected to its neighbours and to the goal. A straight
-- edge to the goal costs more for each blocked motion near it, so the next path leaves the tree elsewhere.
local roadmap = guiding_space {
  name = "roadmap",
  space = { "x", "y" },
  resolves = 100,
  graph = function(instance, known)
    local start, goal = instance.start, instance.goal
    local vertices = { { start[1], start[2] }, { goal[1], goal[2] } }
    local blocked = {}
    for _, sample in ipairs(known.samples) do
      if sample.node then vertices[#vertices + 1] = { sample.node[1], sample.node[2] } end
      if sample.blocked_at then blocked[#blocked + 1] = sample.blocked_at end
    end
    local function distance(a, b) return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2) end
    -- The number of blocked motions within half a metre of the first three metres from a to b.
    local function failures(a, b)
      local count, length = 0, distance(a, b)
      for _, place in ipairs(blocked) do
        local t = ((place[1] - a[1]) * (b[1] - a[1]) + (place[2] - a[2]) * (b[2] - a[2])) / (length * length)
        t = math.max(0, math.min(t, 1, 3 / length))
        if distance(place, { a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2]) }) < 0.5 then count = count + 1 end
      end
      return count
    end
    local edges = {}
    for i, a in ipairs(vertices) do
      if i ~= 2 and distance(a, goal) > 0 then
        edges[#edges + 1] = { i, 2, distance(a, goal) * (1 + failures(a, goal)) }
      end
      for j = 3, i - 1 do
        if distance(a, vertices[j]) < 1 then edges[#edges + 1] = { i, j } end
      end
      if i > 2 and distance(a, start) < 1 then edges[#edges + 1] = { 1, i } end
    end
    return { vertices = vertices, edges = edges, start = 1, goal = 2 }
  end,
  heuristic = function(found) return lifted(along(found.path, { radius = 0.5, evidence = 5 })) end,
}

return experiment {
  problems   = { scenes.trap() },
  strategies = {
    { "rrt", rrt { step = 0.5 } },
    { "widened", widened >> rrt { step = 0.5 } },
    { "roadmap", roadmap >> rrt { step = 0.5 } },
    -- The paper's sequence: each space provides one sample, which takes part in the construction of the next.
    { "in turn", sequence { widened, roadmap, turn = 1 } >> rrt { step = 0.5 } },
  },
  seeds      = 5,
  measure    = false,
}
