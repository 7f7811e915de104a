-- SPDX-License-Identifier: GPL-3.0-or-later
-- A robot that cannot move straight to where it should go: it is driven. A motion model says how; kinodynamic_rrt plans
-- with it, and what guides it may forget about it.
--
--   trellis run examples/kinodynamic.lua
--   trellis help motion      trellis help kinodynamic_rrt      trellis help holonomic

-- An aisle with a bend: the direct way to the goal ends at a wall.
local depot = world {
  bounds = {0, 0, 8, 6},
  box {2.4, 0, 2.8, 4.4, name = "long rack"},
  box {5.0, 1.6, 5.4, 6, name = "far rack"},
}

-- Velocities are part of the state of the second-order model, and follow the configuration in start and goal: (x, y,
-- theta, v, omega). Controls that are held for whole steps hit no goal exactly, so the goal is a region.
local cart = problem {
  name = "cart",
  world = depot,
  robot = robot.rectangle(0.5, 0.3),
  motion = motion.unicycle1 { min_speed = 0, max_speed = 1, max_angular_speed = 1.5 },
  start = {1.2, 1, math.pi / 2},
  goal = {7, 5, math.pi / 2},
  goal_tolerance = 0.4,
}
local sledge = problem {
  name = "sledge",
  world = depot,
  robot = robot.rectangle(0.5, 0.3),
  motion = motion.unicycle2 {
    max_speed = 1, max_angular_speed = 1.5,
    max_acceleration = 1, max_angular_acceleration = 3,
  },
  start = {1.2, 1, math.pi / 2, 0, 0},
  goal = {7, 5, math.pi / 2, 0, 0},
  goal_tolerance = 0.5,
}
local car = problem {
  name = "car",
  world = depot,
  robot = robot.rectangle(0.5, 0.3),
  motion = motion.car { wheelbase = 0.3, max_speed = 1, max_steering = 0.6 },
  start = {1.2, 1, math.pi / 2},
  goal = {7, 5, math.pi / 2},
  goal_tolerance = 0.4,
}

return experiment {
  problems   = { cart, sledge, car },
  strategies = {
    { "unguided",      kinodynamic_rrt {} },
    -- The same robot without its motion model finds a path first.
    { "holonomic",     holonomic() >> kinodynamic_rrt {} },
    -- The path of the reference point, triangle by triangle.
    { "decomposition", decomposition() >> kinodynamic_rrt {} },
    -- And both: the medial axis guides the robot without wheels, whose path guides the one with them.
    { "nested",        skeleton() >> holonomic() >> kinodynamic_rrt {} },
  },
  seeds = 5,
}
