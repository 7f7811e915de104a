-- SPDX-License-Identifier: MIT-0
-- A two-joint arm between two obstacles: Figure 1 of Attali et al. 2022.
--
--   trellis run examples/two_joint_arm.lua --figures pictures
--
-- pictures/two_joint_arm/lazy/motion.svg shows the arm along the path of lazy(), and beside it the space of its
-- two angles, a torus: the invalid configurations, that path, and the density of the planner's proposals.
--
-- `joints { first = 1 }` keeps the first joint: S is a circle, and the arm in it has one link.

local arm = problem {
  name = "two_joint_arm",
  robot = robot.arm { links = {2.4, 2}, width = 0.25, base = {5, 5} },
  world = world {
    bounds = {0, 0, 10, 10},
    box {6.2, 7, 8.2, 8.2, name = "upper box"},
    box {6.8, 2.2, 8, 3.6, name = "lower box"},
  },
  start = {1.9, 0.4},
  goal = {-0.9, -0.5},
  resolution = 0.02,
}

local planner = rrt { step = 0.1 }

return experiment {
  problems   = { arm },
  strategies = {
    rrt    = planner,
    lazy   = lazy() >> planner,
    joints = joints { first = 1 } >> planner,
  },
  seeds   = 5,
  measure = tube { delta = 0.1 },
}
