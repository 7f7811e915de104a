-- SPDX-License-Identifier: MIT-0
-- Worlds that a seed generates
--
-- Each function makes a problem, and takes a table of what shall differ:
--
--   worlds.maze { cells = 12, seed = 2 }
--   worlds.false_gaps { rows = 6, kind = "bent", size = 0.8 }
--
-- The robot is that of the paper's scenes, 0.6 x 0.2 metres, times `size`. The same options give the same world in
-- every run: they do not use math.random, which follows the run's seed.

local _, native = ...

local worlds = {}

-- A generator of random numbers with a seed of its own: splitmix64.
local function random_of(seed)
  local state = seed
  -- In [0, 1).
  local function random()
    state = state + 0x9E3779B97F4A7C15
    local z = state
    z = (z ~ (z >> 30)) * 0xBF58476D1CE4E5B9
    z = (z ~ (z >> 27)) * 0x94D049BB133111EB
    z = z ~ (z >> 31)
    return (z >> 11) / 2.0 ^ 53
  end
  return {
    between = function(lo, hi) return lo + (hi - lo) * random() end,
    -- In 1 ... n.
    index = function(n) return 1 + math.floor(n * random()) end,
    chance = function(share) return random() < share end,
  }
end

local function integer(x) return math.tointeger(x) or math.floor(x) end

local function robot_of(size) return robot.rectangle(0.6 * size, 0.2 * size) end

-- A function that returns a problem from the result of `make(options, random)`: bounds, obstacles, start and goal.
local function generated(name, summary, usage, options, make)
  options[#options + 1] = {
    name = "size", unit = "times 0.6 x 0.2 m", default = 1, lo = 0.01, hi = 10, doc = "the robot's size",
  }
  options[#options + 1] = {
    name = "name", type = "string", default = name, expects = "a string", doc = "how the report calls it",
  }
  worlds[name] = native.define({
    "worlds." .. name, summary, returns = "problem", usage = usage, options = options,
  }, function(o)
    local bounds, obstacles, start, goal = make(o, random_of(integer(o.seed or 1)))
    return problem {
      name = o.name, world = world { bounds = bounds, obstacles }, robot = robot_of(o.size), start = start, goal = goal,
    }
  end)
end

local function count(name, default, doc, most)
  return { name = name, unit = name, default = default, lo = 1, hi = most or 100, doc = doc }
end
local seed = {
  name = "seed", default = 1, lo = 0, hi = 2 ^ 31, doc = "of the random numbers that the world is made of",
}

-- Generated worlds ------------------------------------------------------------------------------------------------

-- A growing tree: each step opens a wall from a cell of the tree to a cell outside it. The newest cell first gives long
-- corridors; a random one gives many short dead ends.
generated("maze", "a perfect maze: exactly one route joins any two cells, which are 1 metre wide",
  "worlds.maze { cells = 12, seed = 2 }", {
    count("cells", 12, "cells along each side"),
    {
      name = "branching", unit = "share of steps", default = 0, lo = 0, hi = 1,
      doc = "steps that continue from a random cell",
    },
    seed,
  }, function(o, random)
    local n = integer(o.cells)
    local function key(x, y) return (x - 1) * n + y end
    local opened, reached, tree = {}, { [key(1, 1)] = true }, { {1, 1} }
    while #tree > 0 do
      local i = random.chance(o.branching) and random.index(#tree) or #tree
      local x, y = tree[i][1], tree[i][2]
      local next_cells = {}
      for _, step in ipairs { {1, 0}, {-1, 0}, {0, 1}, {0, -1} } do
        local a, b = x + step[1], y + step[2]
        if a >= 1 and a <= n and b >= 1 and b <= n and not reached[key(a, b)] then
          next_cells[#next_cells + 1] = {a, b}
        end
      end
      if #next_cells == 0 then
        table.remove(tree, i)
      else
        local a, b = table.unpack(next_cells[random.index(#next_cells)])
        reached[key(a, b)] = true
        -- The wall's lower or left cell, and whether the wall is to the right of it or above it.
        opened[key(math.min(a, x), math.min(b, y)) .. (a ~= x and "right" or "up")] = true
        tree[#tree + 1] = {a, b}
      end
    end
    local walls, half = {}, 0.04
    for x = 1, n do
      for y = 1, n do
        if x < n and not opened[key(x, y) .. "right"] then
          walls[#walls + 1] = box {x - half, y - 1 - half, x + half, y + half}
        end
        if y < n and not opened[key(x, y) .. "up"] then
          walls[#walls + 1] = box {x - 1 - half, y - half, x + half, y + half}
        end
      end
    end
    return {0, 0, n, n}, walls, {0.5, 0.5, 0}, {n - 0.5, n - 0.5, 0}
  end)

local wall = 1.2    -- metres, of a row of gaps, from side to side
local slot = 2      -- metres of a row that hold one gap

-- A slot of a wall with a straight gap in it.
local function straight_gap(boxes, x, y, width, random)
  local lower = y + random.between(0.3, slot - 0.3 - width)
  boxes[#boxes + 1] = box {x, y, x + wall, lower}
  boxes[#boxes + 1] = box {x, lower + width, x + wall, y + slot}
end

-- A slot with a gap 0.3 wide that turns up or down by a right angle and back. A robot of 0.6 x 0.2 cannot turn about a
-- corner between corridors 0.3 wide: at 45 degrees, 2 (0.3 sqrt(2) - 0.2) = 0.45 is the longest one that can. A disc of
-- the robot's inscribed radius, 0.1, passes; so does a robot of half the size, of which 0.65 is the longest.
local function bent_gap(boxes, x, y, random)
  local width, rise = 0.3, 0.9
  local lower = y + random.between(0.2, slot - 0.2 - width - rise)
  local entry, exit = lower, lower + rise
  if random.chance(0.5) then entry, exit = exit, entry end
  local first, second = x + 0.45, x + 0.75
  local function layer(from, to, bottom, top)
    boxes[#boxes + 1] = box {from, y, to, bottom}
    boxes[#boxes + 1] = box {from, top, to, y + slot}
  end
  layer(x, first, entry, entry + width)
  layer(first, second, lower, lower + rise + width)
  layer(second, x + wall, exit, exit + width)
end

generated("false_gaps", "rows of gaps of which the robot passes one in each row, and a robot of half the size all",
  "worlds.false_gaps { rows = 6, gaps = 4, kind = \"bent\" }", {
    count("rows", 3, "walls between start and goal", 20),
    count("gaps", 4, "false gaps in each wall, beside the true one, which is 0.5 metres wide", 20),
    {
      name = "kind", type = "string", default = "mixed", expects = "\"narrow\", \"bent\" or \"mixed\"",
      doc = "a false gap is 0.15 metres wide (narrow), or 0.3 with two turns too tight for the robot's length, " ..
        "although a disc of its inscribed radius passes (bent); mixed has both",
    },
    seed,
  }, function(o, random)
    if o.kind ~= "narrow" and o.kind ~= "bent" and o.kind ~= "mixed" then
      native.fail("worlds.false_gaps: field 'kind' must be \"narrow\", \"bent\" or \"mixed\", got \"" .. o.kind .. '"')
    end
    local rows, slots, space = integer(o.rows), integer(o.gaps) + 1, 1.6
    local boxes, true_slot = {}, 0
    for row = 1, rows do
      local x = space + (row - 1) * (wall + space)
      -- The next true gap is not opposite the last one.
      local other = random.index(slots - (row > 1 and 1 or 0))
      true_slot = (row > 1 and other >= true_slot) and other + 1 or other
      for s = 1, slots do
        local y = (s - 1) * slot
        if s == true_slot then
          straight_gap(boxes, x, y, 0.5, random)
        elseif o.kind == "bent" or (o.kind == "mixed" and random.chance(0.5)) then
          bent_gap(boxes, x, y, random)
        else
          straight_gap(boxes, x, y, 0.15, random)
        end
      end
    end
    local width, height = space + rows * (wall + space), slots * slot
    return {0, 0, width, height}, boxes, {0.8, 0.5 * height, 0}, {width - 0.8, 0.5 * height, 0}
  end)

generated("rooms", "rooms with doors; the doors that the robot passes join any two rooms by one route",
  "worlds.rooms { rooms = 4, narrow = 0.5 }", {
    count("rooms", 4, "rooms along each side, each 2.5 metres wide", 20),
    {
      name = "narrow", unit = "share of walls", default = 0.6, lo = 0, hi = 1,
      doc = "of the other walls, those that have a door 0.15 metres wide",
    },
    seed,
  }, function(o, random)
    local n, side, half = integer(o.rooms), 2.5, 0.1
    local walls = {}
    for x = 1, n do
      for y = 1, n do
        if x < n then walls[#walls + 1] = {x, y, upright = true} end
        if y < n then walls[#walls + 1] = {x, y, upright = false} end
      end
    end
    for i = #walls, 2, -1 do
      local k = random.index(i)
      walls[i], walls[k] = walls[k], walls[i]
    end
    -- Kruskal's algorithm: a wall between two components gets a door that the robot passes.
    local parent = {}
    local function component(i)
      while parent[i] do i = parent[i] end
      return i
    end
    local boxes = {}
    for _, w in ipairs(walls) do
      local x, y = w[1], w[2]
      local here = component(x * 100 + y)
      local there = component(w.upright and (x + 1) * 100 + y or x * 100 + y + 1)
      local door = 0
      if here ~= there then
        parent[here] = there
        door = random.between(0.45, 0.7)
      elseif random.chance(o.narrow) then
        door = 0.15
      end
      -- Along the wall, from one corner of the room to the other.
      local from, across = side * ((w.upright and y or x) - 1), side * (w.upright and x or y)
      local at = from + random.between(0.4, side - 0.4 - door)
      local function part(a, b)
        boxes[#boxes + 1] = w.upright and box {across - half, a, across + half, b} or
          box {a, across - half, b, across + half}
      end
      if door > 0 then
        part(from - half, at)
        part(at + door, from + side + half)
      else
        part(from - half, from + side + half)
      end
    end
    local far = n * side - 0.5 * side
    return {0, 0, n * side, n * side}, boxes, {0.5 * side, 0.5 * side, 0}, {far, far, 0}
  end)

generated("boxes", "boxes at random, none near start and goal", "worlds.boxes { boxes = 120, seed = 3 }", {
  count("boxes", 120, "boxes in 10 x 10 metres", 1000), seed,
}, function(o, random)
  local start, goal, all = {0.8, 0.8, 0}, {9.2, 9.2, 0}, {}
  while #all < integer(o.boxes) do
    local x, y, side = random.between(0, 9.6), random.between(0, 9.6), random.between(0.2, 0.5)
    local function clear(q)
      return q[1] < x - 0.6 or q[1] > x + side + 0.6 or q[2] < y - 0.6 or q[2] > y + side + 0.6
    end
    if clear(start) and clear(goal) then all[#all + 1] = box {x, y, x + side, y + side} end
  end
  return {0, 0, 10, 10}, all, start, goal
end)

generated("slalom", "walls that leave an opening 0.7 wide at the top and at the bottom in turn",
  "worlds.slalom { gates = 8 }", { count("gates", 8, "walls") }, function(o)
    local all, pitch = {}, 1.2
    for i = 1, integer(o.gates) do
      local x = 0.4 + i * pitch
      all[i] = i % 2 == 1 and box {x, 0, x + 0.2, 5.3} or box {x, 0.7, x + 0.2, 6}
    end
    local width = 2 + integer(o.gates) * pitch
    return {0, 0, width, 6}, all, {0.7, 3, 0}, {width - 0.7, 3, 0}
  end)

generated("dead_ends", "corridors that all lead towards the goal; all but the farthest end in a slit 0.15 wide",
  "worlds.dead_ends { pockets = 4 }", { count("pockets", 4, "corridors with a slit at their end", 20) }, function(o)
    local pockets, pitch, width = integer(o.pockets), 1.2, 0.6
    local from, to, height = 3, 9, (pockets + 1) * pitch + 2
    local all, top = {}, 0
    for i = 1, pockets + 1 do
      local y = 1 + (i - 0.5) * pitch - 0.5 * width
      all[#all + 1] = box {from, top, to, y}
      if i <= pockets then
        local middle = y + 0.5 * width
        all[#all + 1] = box {to - 0.3, y, to, middle - 0.075}
        all[#all + 1] = box {to - 0.3, middle + 0.075, to, y + width}
      end
      top = y + width
    end
    all[#all + 1] = box {from, top, to, height}
    return {0, 0, 12, height}, all, {1.5, 1.6, 0}, {10.5, 1.6, 0}
  end)

generated("bug_trap", "a box around the start; its only opening, 0.5 wide, leads inwards and faces away from the goal",
  "worlds.bug_trap { size = 0.5 }", {}, function()
    local all = {
      box {5.8, 2.5, 6, 7.5},
      box {1.5, 2.5, 5.8, 2.7},
      box {1.5, 7.3, 5.8, 7.5},
      box {1.5, 2.7, 1.7, 4.75},
      box {1.5, 5.25, 1.7, 7.3},
      box {1.7, 4.55, 3.5, 4.75},
      box {1.7, 5.25, 3.5, 5.45},
    }
    return {0, 0, 10, 10}, all, {4.8, 5, 0}, {9, 5, 0}
  end)

-- Worlds of space -------------------------------------------------------------------------------------------------

-- As `generated`, for a plank of 1.6 x 1 x 0.2 metres times `size`.
local function generated_in_space(name, summary, usage, options, make)
  options[#options + 1] = {
    name = "size", unit = "times 1.6 x 1 x 0.2 m", default = 1, lo = 0.01, hi = 10, doc = "the robot's size",
  }
  options[#options + 1] = {
    name = "name", type = "string", default = name, expects = "a string", doc = "how the report calls it",
  }
  worlds[name] = native.define({
    "worlds." .. name, summary, returns = "problem", usage = usage, options = options,
  }, function(o)
    local bounds, obstacles, start, goal = make(o, random_of(integer(o.seed or 1)))
    local x, y, z = 0.8 * o.size, 0.5 * o.size, 0.1 * o.size
    return problem {
      name = o.name, world = world { bounds = bounds, obstacles }, robot = robot.rigid { box {-x, -y, -z, x, y, z} },
      start = start, goal = goal,
    }
  end)
end

local upright, flat = { axis = {0, 1, 0}, angle = math.pi / 2 }, { axis = {0, 0, 1}, angle = 0 }
local function pose_at(x, y, z, turn) return pose { x, y, z, axis = turn.axis, angle = turn.angle } end

-- A wall of cells of 2.5 metres from x to x + 0.5, each with an opening of this width and height in its middle.
local function windows(boxes, x, cells)
  for i, row in ipairs(cells) do
    for j, opening in ipairs(row) do
      local y, z, to = 2.5 * (i - 1), 2.5 * (j - 1), x + 0.5
      local left, right = y + 1.25 - 0.5 * opening[1], y + 1.25 + 0.5 * opening[1]
      local low, high = z + 1.25 - 0.5 * opening[2], z + 1.25 + 0.5 * opening[2]
      boxes[#boxes + 1] = box {x, y, z, to, left, z + 2.5}
      boxes[#boxes + 1] = box {x, right, z, to, y + 2.5, z + 2.5}
      boxes[#boxes + 1] = box {x, left, z, to, right, low}
      boxes[#boxes + 1] = box {x, left, high, to, right, z + 2.5}
    end
  end
end

generated_in_space("windows", "walls with 16 windows each: a point passes them all, the plank one in each wall",
  "worlds.windows { walls = 2, seed = 3 }", { count("walls", 2, "walls across the world", 3), seed },
  function(o, random)
    local boxes, walls = {}, integer(o.walls)
    for k = 1, walls do
      local cells, open_i, open_j = {}, random.index(4), random.index(4)
      for i = 1, 4 do
        cells[i] = {}
        for j = 1, 4 do cells[i][j] = (i == open_i and j == open_j) and {1.8, 1.0} or {0.7, 0.4} end
      end
      windows(boxes, 10 * k / (walls + 1) - 0.25, cells)
    end
    return {0, 0, 0, 10, 10, 10}, boxes, pose_at(1, 5, 5, upright), pose_at(9, 5, 5, upright)
  end)

generated_in_space("floating_boxes", "boxes at random places in space",
  "worlds.floating_boxes { boxes = 80, seed = 2 }", { count("boxes", 60, "boxes", 1000), seed },
  function(o, random)
    local boxes = {}
    while #boxes < integer(o.boxes) do
      local centre, half, near = {}, {}, { 0, 0 }
      for axis, ends in ipairs { {1, 9}, {1, 9}, {1, 9} } do
        centre[axis], half[axis] = random.between(0, 10), random.between(0.2, 0.8)
        for i = 1, 2 do near[i] = math.max(near[i], math.abs(centre[axis] - ends[i]) - half[axis]) end
      end
      -- Start and goal stay free.
      if near[1] > 0.95 * math.max(1, o.size) and near[2] > 0.95 * math.max(1, o.size) then
        local lo, hi = {}, {}
        for axis = 1, 3 do
          lo[axis] = math.max(0, centre[axis] - half[axis])
          hi[axis] = math.min(10, centre[axis] + half[axis])
        end
        boxes[#boxes + 1] = box {lo[1], lo[2], lo[3], hi[1], hi[2], hi[3]}
      end
    end
    return {0, 0, 0, 10, 10, 10}, boxes, pose_at(1, 1, 1, flat), pose_at(9, 9, 9, flat)
  end)

generated_in_space("slot", "a slot between two blocks, which the plank passes lying flat",
  "worlds.slot { gap = 0.5 }",
  { { name = "gap", unit = "m", default = 0.6, lo = 0.25, hi = 5, doc = "the slot's height" } },
  function(o)
    local below, above = 5 - 0.5 * o.gap, 5 + 0.5 * o.gap
    local boxes = { box {4, 0, 0, 6, 10, below}, box {4, 0, above, 6, 10, 10} }
    return {0, 0, 0, 10, 10, 10}, boxes, pose_at(1, 5, 5, upright), pose_at(9, 5, 5, upright)
  end)

return worlds
