-- SPDX-License-Identifier: GPL-3.0-or-later
-- Robots with motion models, for the hashes of whole runs (tests/cli/determinism.cpp).
local depot = world {
  bounds = {0, 0, 8, 6},
  box {2.4, 0, 2.8, 4.4},
  box {5.0, 1.6, 5.4, 6},
}

local function driven(name, model, speeds)
  local start, goal = {1.2, 1, math.pi / 2}, {7, 5, math.pi / 2}
  for _ = 1, speeds do
    start[#start + 1] = 0
    goal[#goal + 1] = 0
  end
  return problem {
    name = name, world = depot, robot = robot.rectangle(0.5, 0.3), motion = model, start = start, goal = goal,
    goal_tolerance = 0.5,
  }
end

return experiment {
  problems = {
    driven("unicycle1", motion.unicycle1 { min_speed = 0, max_speed = 1, max_angular_speed = 1.5 }, 0),
    driven("unicycle2", motion.unicycle2 {
      max_speed = 1, max_angular_speed = 1.5, max_acceleration = 1, max_angular_acceleration = 3,
    }, 2),
    driven("car", motion.car { wheelbase = 0.3, max_speed = 1, max_steering = 0.6 }, 0),
  },
  seeds      = 2,
  measure    = false,
  strategies = {
    { "kinodynamic_rrt", kinodynamic_rrt { proposals = 2000 } },
    { "holonomic",       holonomic() >> kinodynamic_rrt { proposals = 2000 } },
    { "blossom",         blossom() >> kinodynamic_rrt { proposals = 2000 } },
    { "decomposition",   decomposition() >> kinodynamic_rrt { proposals = 2000 } },
    { "nested",          skeleton() >> holonomic() >> kinodynamic_rrt { proposals = 2000 } },
  },
}
