-- SPDX-License-Identifier: GPL-3.0-or-later
-- The arm of docs/tutorials/robot.md before its shelf, all joints and two of them, for check_arm_path.py.
local picker = robot.urdf("picker.urdf", { srdf = "picker.srdf", group = "arm" })
local folding = robot.urdf("picker.urdf", { srdf = "picker.srdf", group = {"lift", "elbow"}, values = { bend = 2 } })

local shelf = world {
  bounds = {-1.2, -1.2, -0.2, 1.2, 1.2, 1.6}, contain = "none",
  box { -1.2, -1.2, -0.2, 1.2, 1.2, -0.02, name = "floor" },
  box { 0.5, -0.4, 0.50, 0.9, 0.4, 0.54, name = "lower board" },
  box { 0.5, -0.4, 0.90, 0.9, 0.4, 0.94, name = "upper board" },
  box { 0.86, -0.4, 0.54, 0.9, 0.4, 0.90, name = "back" },
}

local pick = problem {
  name = "pick", world = shelf, robot = picker, resolution = 0.04, start = "home",
  goal = reach { link = "grasp", pose = pose {0.68, 0.15, 0.74, rpy = {0, math.pi / 2, 0}}, within = {0.02, 1} },
}
local fold = problem { name = "fold", world = shelf, robot = folding, start = {0.9, -2.4}, goal = {-0.6, 2.4} }

return experiment {
  problems = { pick, fold }, strategies = { { "rrt_connect", rrt_connect { step = 0.5 } } }, seeds = 2, measure = false,
}
