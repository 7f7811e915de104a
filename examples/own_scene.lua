-- SPDX-License-Identifier: MIT-0
-- A user-defined world and robot.
--
--   trellis run examples/own_scene.lua
--   trellis help world      trellis help robot.rigid      trellis help problem

-- Lengths are in metres, angles in radians. The whole robot stays inside the bounds. A name shows in messages, for
-- example when a start touches an obstacle.
local yard = world {
  bounds = {0, 0, 12, 8},
  box {5, 0, 5.4, 3, name = "lower fence"},
  box {5, 4.2, 5.4, 8, name = "upper fence"},
  polygon { {7, 2}, {9, 2.5}, {8.2, 3.4}, {9, 5}, {7.4, 4.2}, name = "rock" },
}

-- Lists of obstacles are flattened, so a loop can create them. math.random follows the run's seed (--seed).
local trees = {}
for i = 1, 6 do
  trees[i] = disc { 1.5 + 0.45 * i, 6.5 + 0.4 * math.random(), 0.12, name = "tree " .. i }
end
local park = world {
  bounds = {0, 0, 12, 8},
  trees,
  box {5, 0, 5.4, 3},
  box {5, 4.2, 5.4, 8},
}

-- One rigid body of several parts: a body with a shovel in front and a round tail. Its reference point is (0, 0).
local digger = robot.rigid {
  box {-0.3, -0.15, 0.3, 0.15},
  polygon { {0.3, -0.25}, {0.5, -0.25}, {0.5, 0.25}, {0.3, 0.25}, {0.4, 0} },
  disc {-0.3, 0, 0.15},
}

return experiment {
  problems = {
    problem { name = "yard", world = yard, robot = digger, start = {1, 1.5, 0}, goal = {11, 6, math.pi / 2} },
    problem { name = "park", world = park, robot = robot.disc(0.2), start = {1, 1}, goal = {11, 7} },
  },
  strategies = {
    rrt      = rrt { step = 0.5 },
    connect  = rrt_connect { step = 0.5 },
    skeleton = skeleton() >> rrt { step = 0.5 },
  },
  seeds = 3,
}
