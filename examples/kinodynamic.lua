-- SPDX-License-Identifier: MIT-0
-- Kinodynamic planning: the robot cannot move straight to every configuration. kinodynamic_rrt plans with its motion
-- model; guides may relax the model.
--
--   trellis run examples/kinodynamic.lua
--   trellis help motion      trellis help kinodynamic_rrt      trellis help holonomic

-- An aisle with a bend: the straight line to the goal ends at a wall.
local depot = world {
  bounds = {0, 0, 8, 6},
  box {2.4, 0, 2.8, 4.4, name = "long rack"},
  box {5.0, 1.6, 5.4, 6, name = "far rack"},
}

-- Velocities are part of the state of the second-order model, and follow the configuration in start and goal: (x, y,
-- theta, v, omega). Controls that are constant for whole steps hit no goal exactly, so the goal is a region.
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
    -- The guide plans for the same robot without its motion model first.
    { "holonomic",     holonomic() >> kinodynamic_rrt {} },
    -- The path of the reference point, triangle by triangle.
    { "decomposition", decomposition() >> kinodynamic_rrt {} },
    -- Both: the medial axis guides the holonomic robot, whose path guides the kinodynamic one.
    { "nested",        skeleton() >> holonomic() >> kinodynamic_rrt {} },
  },
  seeds = 5,
}
