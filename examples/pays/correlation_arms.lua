-- SPDX-License-Identifier: MIT-0
-- As correlation.lua, for arms that are fixed to their base: those of examples/arms.lua.
--
--   trellis run examples/pays/correlation_arms.lua --quiet --json arms.json
--   trellis report arms.json --out arms

local guides = require "guides"

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

return experiment {
  problems   = problems,
  strategies = guides.over("rrt", rrt, { step = 0.3, proposals = 20000 }, "arms"),
  baseline   = "rrt",
  seeds      = 5,
  measure    = tube { delta = 0.5 },
  ablation   = 0,
}
