-- SPDX-License-Identifier: MIT-0
-- Arms that are fixed to their base: the path of the tip guides all joints.
--
--   trellis run examples/arms.lua --json costs.json
--   trellis report costs.json --report costs --figures costs   prints ratios, writes figures and tables
--
-- `skeleton()` follows the medial axis of the space that the tip of the arm reaches; inverse kinematics computes the
-- joint angles for each point, one after another. It saves checks where the path of the tip is hard to find (the gaps,
-- the boxes), and costs checks where the arm has to fold first (the narrow shelf).

local function arm(name, links, width, base, boxes, start, goal)
  boxes.bounds = {0, 0, 10, 10}
  return problem {
    name  = name,
    robot = robot.arm { links = links, width = width, base = base },
    world = world(boxes),
    start = start,
    goal  = goal,
  }
end

local problems = {
  arm("gap", {1.6, 1.6, 1.6, 1.6}, 0.15, {5, 1}, {
      box {0, 4, 4.5, 4.3}, box {5.5, 4, 10, 4.3},
    },
    {-0.493, 0.426, 0.772, 1.738},
    {2.430, -1.303, -0.184, -0.413}),
  arm("far_gap", {1.4, 1.4, 1.4, 1.4, 1.4}, 0.15, {3, 1}, {
      box {0, 4, 4.6, 4.4}, box {5.4, 4, 10, 4.4},
    },
    {-0.395, 1.818, 0.903, 0.181, 1.157},
    {0.578, 0.920, -0.440, -0.494, -0.078}),
  arm("shelf", {1.4, 1.4, 1.4, 1.4, 1.4}, 0.15, {2, 5}, {
      box {5.5, 2, 9, 2.2}, box {5.5, 3.9, 9, 4.1}, box {5.5, 5.9, 9, 6.1}, box {5.5, 7.8, 9, 8},
      box {9, 2, 9.2, 8},
    },
    {-1.415, 0.565, 1.015, 0.251, -0.669},
    {-0.162, 0.356, 1.545, -1.307, -0.443}),
  arm("narrow_shelf", {1.2, 1.2, 1.2, 1.2, 1.2, 1.2}, 0.12, {2.5, 5}, {
      box {5, 2, 9, 2.2}, box {5, 3.4, 9, 3.6}, box {5, 4.9, 9, 5.1}, box {5, 6.4, 9, 6.6}, box {5, 7.8, 9, 8},
      box {9, 2, 9.2, 8},
    },
    {-2.144, 0.776, 1.444, -0.204, 0.459, -0.612},
    {2.100, -0.868, -1.069, -0.356, -0.064, 0.562}),
  arm("boxes", {0.8, 0.8, 0.8, 0.8, 0.8, 0.8}, 0.12, {5, 5}, {
      box {6.2, 5.6, 7.2, 6.6}, box {6.4, 3.2, 7.4, 4.2}, box {4.2, 7, 5.2, 8}, box {2.4, 5.2, 3.4, 6.2},
      box {3.2, 2.6, 4.2, 3.4}, box {5.2, 1.6, 6, 2.4},
    },
    {-1.812, -0.589, -1.113, -0.438, 2.310, -2.089},
    {0.496, -0.794, -0.674, 1.149, -0.700, 2.346}),
}

local planner = rrt_connect { step = 0.3 }

return experiment {
  problems   = problems,
  strategies = {
    rrt_connect = planner,
    skeleton    = skeleton() >> planner,
    workspace   = workspace() >> planner,
    shrink      = shrink { 0.5, planner = planner } >> planner,
    nested      = skeleton() >> shrink { 0.5, planner = planner } >> planner,
  },
  seeds    = 5,
  baseline = "rrt_connect",
  measure  = false,
}
