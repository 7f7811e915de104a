-- SPDX-License-Identifier: MIT-0
-- Named problems, and problems from files
--
-- Each function that is named after a scene makes a problem, and takes a table of what shall differ:
--
--   scenes.trap { collision = "fcl", resolution = 0.02, start = {1, 5, 0} }
--
-- simple_passage, trap and cup are those of Attali et al. 2022: a robot of 0.6 x 0.2 metres in a world of 10 x 10.

local _, native = ...

local scenes = {}

local attali = "Attali et al. 2022, Evaluating Guiding Spaces for Motion Planning"

-- A function that makes the problem `default`, with fields replaced by those of its argument.
local function scene(summary, default)
  return native.define({
    "scenes." .. default.name, summary,
    source = attali, returns = "problem", usage = "scenes." .. default.name .. " { resolution = 0.02 }",
    options = { like = "problem", default = default },
  }, problem)
end

scenes.simple_passage = scene("a corridor 0.5 wide and 2 long", {
  name = "simple_passage",
  robot = robot.rectangle(0.6, 0.2),
  world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 4.75}, box {4, 5.25, 6, 10} },
  start = {1, 8.5, 0},
  goal = {9, 1.5, 0},
})

-- Four gaps are 0.15 wide, too narrow for the robot; the boxes at x = 5.3 close two of width 0.5 after 0.8. The robot
-- passes at y = 8.75.
scenes.trap = scene("four false passages, two dead ends, and one true passage far off the direct path", {
  name = "trap",
  robot = robot.rectangle(0.6, 0.2),
  world = world {
    bounds = {0, 0, 10, 10},
    box {4.5, 0, 5.5, 1.925},
    box {4.5, 2.075, 5.5, 3.325},
    box {4.5, 3.475, 5.5, 4.525},
    box {4.5, 4.675, 5.5, 5.05},
    box {5.3, 5.05, 5.5, 5.55},
    box {4.5, 5.55, 5.5, 5.925},
    box {4.5, 6.075, 5.5, 6.95},
    box {5.3, 6.95, 5.5, 7.45},
    box {4.5, 7.45, 5.5, 8.75},
    box {4.5, 9.25, 5.5, 10},
  },
  start = {1, 4, 0},
  goal = {9, 4, 0},
})

scenes.cup = scene("a U-shaped wall, open towards the start, with the goal behind it", {
  name = "cup",
  robot = robot.rectangle(0.6, 0.2),
  world = world {
    bounds = {0, 0, 10, 10},
    box {6.5, 1.5, 7, 8.5, name = "the cup's bottom"},
    box {3, 1.5, 6.5, 2, name = "the cup's lower wall"},
    box {3, 8, 6.5, 8.5, name = "the cup's upper wall"},
  },
  start = {1, 5, 0},
  goal = {9, 5, 0},
})

scenes.load = native.load_scene
scenes.robot = native.load_robot
scenes.exists = native.scene_exists

return scenes
