-- SPDX-License-Identifier: MIT-0
-- Discs that cross: the planar scenarios of the benchmarks of ARC, P-ARC and AO-ARC, by the geometry that the program
-- mobile_robot_2d_crossing of CoMotion (github.com/parasollab/comotion) makes: radius 0.5 m, 5 m between robots.
--
--   trellis run examples/crossing.lua
--
-- docs/teams.md says more.

local radius, spacing = 0.5, 5

local function crossing(name, bounds, start, goal, obstacles)
  return problem { name = name, world = world { bounds = bounds, obstacles or {} },
                   robot = robots { robot.disc(radius), count = #start }, start = start, goal = goal }
end

-- On a circle; each goes to the place opposite.
local function circle(count)
  local r = math.max(spacing, spacing * count / (2 * math.pi))
  local start, goal = {}, {}
  for i = 1, count do
    local x, y = r * math.cos(2 * math.pi * i / count), r * math.sin(2 * math.pi * i / count)
    start[i], goal[i] = { x, y }, { -x, -y }
  end
  local side = r + 2 * radius
  return crossing("circle " .. count, {-side, -side, side, side}, start, goal)
end

-- Two robots on each of parallel lines; both go to the other's place.
local function parallel(count)
  local lines = count // 2
  local x = spacing * lines
  local start, goal = {}, {}
  for i = 1, lines do
    local y = (i - (lines + 1) / 2) * spacing
    start[2 * i - 1], goal[2 * i - 1] = { x, y }, { -x, y }
    start[2 * i], goal[2 * i] = { -x, y }, { x, y }
  end
  local side = x + 2 * radius
  return crossing("parallel " .. count, {-side, -side, side, side}, start, goal)
end

-- A corridor as wide as two discs, with a bay of the same width half-way.
local function inlet()
  return crossing("inlet", {-10, 0, 10, 4}, { {-9, 1}, {9, 1} }, { {9, 1}, {-9, 1} },
                  { box {-10, 2, -1, 4}, box {1, 2, 10, 4} })
end

local planner = rrt_connect { bound = 0, proposals = 5000 }
return experiment {
  problems   = { circle(4), circle(8), circle(16), parallel(8), parallel(32), inlet() },
  strategies = { alone = rrt_connect { proposals = 5000 }, prioritise = prioritise() >> planner,
                 couple = couple() >> planner },
  seeds      = 3,
  baseline   = "alone",
  measure    = false,
}
