-- SPDX-License-Identifier: GPL-3.0-or-later
-- Named problems, and problems from files.
--
--   scenes.simple_passage()   a corridor 0.5 wide and 2 long
--   scenes.trap()             four false passages, two dead ends, and one true passage far off the direct way
--   scenes.cup()              a U-shaped wall, open towards the start, with the goal behind it
--   scenes.load(FILE)         the problems of a scene file made by others
--   scenes.exists(FILE)       whether there is such a file
--
-- The first three are those of Attali et al. 2022: a robot of 0.6 x 0.2 metres in a world of 10 x 10. Each is a
-- problem, and takes a table of what shall differ from the paper:
--
--   scenes.trap { collision = "fcl", resolution = 0.02, start = {1, 5, 0} }
--
-- FILE is looked for in the script's folder and then in the folder of scenes (TRELLIS_SCENES).

local _, native = ...

local scenes = {}

-- A function that makes the problem `default`, with fields replaced by those of its argument.
local function scene(default)
  return function(changes)
    if changes ~= nil and type(changes) ~= "table" then
      native.fail("scenes." .. default.name .. ": takes a table of what shall differ, got " .. tostring(changes))
    end
    local fields = {}
    for name, value in pairs(default) do fields[name] = value end
    for name, value in pairs(changes or {}) do fields[name] = value end
    return problem(fields)
  end
end

scenes.simple_passage = scene {
  name = "simple_passage",
  robot = robot.rectangle(0.6, 0.2),
  world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 4.75}, box {4, 5.25, 6, 10} },
  start = {1, 8.5, 0},
  goal = {9, 1.5, 0},
}

-- Four gaps are 0.15 wide, too narrow for the robot; two of 0.5 are closed after 0.8 by the boxes at x = 5.3. The gap
-- at y = 8.75 is the way.
scenes.trap = scene {
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
}

scenes.cup = scene {
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
}

scenes.load = native.load_scene
scenes.exists = native.scene_exists

return scenes
