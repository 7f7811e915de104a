-- SPDX-License-Identifier: GPL-3.0-or-later
-- What guides are good for, and where they mislead, on worlds made for it.

local function in_world(walls, start, goal)
  walls.bounds = {0, 0, 10, 10}
  return problem {
    name  = "made for it",
    world = world(walls),
    robot = robot.rectangle(0.6, 0.2),
    start = start,
    goal  = goal,
  }
end

scenario "regions along the medial axis find a doorway" (function()
  local it = given {
    problem = in_world({ box {4, 0, 6, 7.5}, box {4, 8, 6, 10} }, {1, 1, 0}, {9, 1, 0}),
    strategies = { guided = skeleton() >> rrt { step = 0.5 }, plain = rrt { step = 0.5 } },
    measure = tube { delta = 0.5, points = 512 },
  }
  local guided, plain = when { it.guided, it.plain, seeds = 20 }
  expect(guided, solves(at_least(0.95)))
  expect(guided, finds_paths())
  expect(guided, spends(below(plain).validity_checks().by(0.2)))
  expect(guided, has_efficiency("root", above(plain), { part = "mass" }))
end)

scenario "a bias to the goal gains where nothing blocks the path" (function()
  local it = given {
    problem = in_world({ box {0, 9, 1, 10} }, {1, 1, 0}, {9, 8, 0}),
    strategies = {
      greedy = rrt { step = 0.5, goal_bias = 0.5 },
      patient = rrt { step = 0.5, goal_bias = 0 },
    },
  }
  local greedy, patient = when { it.greedy, it.patient, seeds = 20 }
  expect(greedy, spends(below(patient).nodes().by(0.5).with_confidence(0.99)))
  expect(greedy, finds_paths(below(patient)))
end)

scenario "a budget that is spent before there is a path is reported as it is" (function()
  local it = given {
    problem = in_world({ box {4, 0, 6, 7.5}, box {4, 8, 6, 10} }, {1, 1, 0}, {9, 1, 0}),
    strategies = { hopeless = rrt { step = 0.5, proposals = 20 } },
  }
  local hopeless = when { it.hopeless, seeds = 5 }
  expect(hopeless, solves(exactly(0)))
  expect(hopeless, spends(exactly(20).proposals()))
end)
