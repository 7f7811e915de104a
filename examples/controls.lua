-- SPDX-License-Identifier: MIT-0
-- A guide that draws controls: not only where to extend, and from which node, but under which control of the robot.
--
--   trellis run examples/controls.lua
--
-- The function that draws may return a table: `to`, the configuration to extend towards, and if it likes `node`, the
-- number of the node to extend, and `control` with its `duration`. The planner then drives the node under that control.
-- It chooses its own controls for the proposals that the guide did not draw, so the guide cannot make it incomplete.
--
-- `steer` plans for a disc in the plane first. It extends the node with the least length of that path ahead of it, for
-- how often it was extended, under the one of some random controls that ends with the least. The built-in guide
-- `blossom` does the same with the robot's own shape, and keeps the controls of a node for its next extension.

local candidates = 12
local beside = 2 -- a metre beside the path costs as much as so many along it

-- An aisle with a bend: the straight line to the goal ends at a wall.
local depot = world {
  bounds = {0, 0, 8, 6},
  box {2.4, 0, 2.8, 4.4, name = "long rack"},
  box {5.0, 1.6, 5.4, 6, name = "far rack"},
}

-- Points of a path 0.1 m apart, each with the length of the path from there on.
local function points_of(path)
  local points = {}
  for i = 1, #path - 1 do
    local a, b = path[i], path[i + 1]
    local parts = math.max(1, math.ceil(math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2) / 0.1))
    for k = 0, parts - 1 do
      points[#points + 1] = { x = a[1] + (b[1] - a[1]) * k / parts, y = a[2] + (b[2] - a[2]) * k / parts }
    end
  end
  points[#points + 1] = { x = path[#path][1], y = path[#path][2], left = 0 }
  for i = #points - 1, 1, -1 do
    local a, b = points[i], points[i + 1]
    a.left = b.left + math.sqrt((b.x - a.x) ^ 2 + (b.y - a.y) ^ 2)
  end
  return points
end

local function steer()
  local points, instance
  local nodes, of_number = {}, {}

  -- The length ahead of a state: to a point of the path, and along it. Points are near that of the node before.
  local function ahead(q, near)
    local least, at = math.huge, 1
    for i = math.max(1, near - 15), math.min(#points, near + 25) do
      local p = points[i]
      local length = p.left + beside * math.sqrt((p.x - q[1]) ^ 2 + (p.y - q[2]) ^ 2)
      if length < least then least, at = length, i end
    end
    return least, at
  end

  local function priority(node) return node.left * (1 + 0.1 * node.extended) end

  local function within(q)
    for i = 1, #q do
      if q[i] < instance.space.lower[i] or q[i] > instance.space.upper[i] then return false end
    end
    return true
  end

  local function add(q, number, near)
    local node = { q = table.move(q, 1, #q, 1, {}), number = number, extended = 0 }
    node.left, node.at = ahead(node.q, near)
    nodes[#nodes + 1] = node
    if number then of_number[number] = node end
  end

  return guiding_space {
    name = "steer",
    space = { "x", "y" },
    robot = robot.disc(0.15),
    planner = rrt_connect { step = 0.5 },
    heuristic = function(found, c)
      instance, points = c, points_of(found.path)
      nodes, of_number = {}, {}
      add(c.start, nil, 1)
      local motion = c.motion
      return function(random)
        local node = nodes[1]
        for _, other in ipairs(nodes) do
          if priority(other) < priority(node) then node = other end
        end
        local best
        for _ = 1, candidates do
          local control = {}
          for j, u in ipairs(motion.controls) do control[j] = u.lower + random() * (u.upper - u.lower) end
          local duration = motion.dt * math.ceil(10 * random())
          local to = c:drive(node.q, control, duration)
          local left = ahead(to, node.at)
          if within(to) and (not best or left < best.left) then
            best = { to = to, left = left, control = control, duration = duration }
          end
        end
        node.extended = node.extended + 1
        if not best then return { to = node.q, node = node.number } end
        return { to = best.to, node = node.number, control = best.control, duration = best.duration }
      end
    end,
    observe = function(outcome)
      if not outcome.added or not points then return end
      local from = of_number[outcome.near_number]
      add(outcome.added, outcome.number, from and from.at or 1)
    end,
  }
end

local function problem_of(name, model, start, goal)
  return problem {
    name = name, world = depot, robot = robot.rectangle(0.5, 0.3), motion = model, start = start, goal = goal,
    goal_tolerance = 0.5,
  }
end

return experiment {
  problems = {
    problem_of("cart", motion.unicycle1 { min_speed = 0, max_speed = 1, max_angular_speed = 1.5 },
      {1.2, 1, math.pi / 2}, {7, 5, math.pi / 2}),
    problem_of("sledge", motion.unicycle2 {
      max_speed = 1, max_angular_speed = 1.5, max_acceleration = 1, max_angular_acceleration = 3,
    }, {1.2, 1, math.pi / 2, 0, 0}, {7, 5, math.pi / 2, 0, 0}),
  },
  strategies = {
    { "unguided",  kinodynamic_rrt {} },
    { "holonomic", holonomic() >> kinodynamic_rrt {} },
    { "steer",     steer() >> kinodynamic_rrt {} },
    { "blossom",   blossom() >> kinodynamic_rrt {} },
    { "unbound",   blossom() >> kinodynamic_rrt { bound = 0 } }, -- no planner beside it
  },
  seeds    = 10,
  baseline = "unguided",
  measure  = progress {},
}
