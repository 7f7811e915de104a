-- SPDX-License-Identifier: MIT-0
-- A wall with a window, as a sensor sees it: points, each with a ball about it. Here a loop makes them; a file is read
-- by point_cloud { "scan.pcd", radius = 0.06 }.
--
--   trellis run examples/point_cloud.lua

-- Half the diagonal of the pattern is 0.071 m: balls of 0.08 m leave no gap.
local points = { radius = 0.08, name = "scan" }
for y = 0.05, 4, 0.1 do
  for z = 0.05, 2, 0.1 do
    local window = y > 2.6 and y < 3.4 and z > 0.8 and z < 1.6
    if not window then points[#points + 1] = { 2 + 0.02 * math.sin(9 * y + 5 * z), y, z } end
  end
end

local flat = problem {
  name  = "window",
  world = world { bounds = { 0, 0, 0, 4, 4, 2 }, point_cloud(points) },
  robot = robot.rigid { box { -0.3, -0.15, -0.1, 0.3, 0.15, 0.1 } },
  start = pose { 0.6, 0.6, 0.5 },
  goal  = pose { 3.4, 0.6, 0.5 },
}

return experiment {
  problems   = { flat },
  strategies = {
    rrt_connect = rrt_connect { step = 0.5 },
    workspace   = workspace() >> rrt_connect { step = 0.5 },
    nested      = skeleton() >> lazy() >> rrt_connect { step = 0.5 },
  },
  baseline   = "rrt_connect",
  seeds      = 5,
}
