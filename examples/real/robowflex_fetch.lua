-- SPDX-License-Identifier: MIT-0
-- A Fetch before a shelf with cans, by motion capture: five scenes of robowflex with their requests.
--
--   trellis run examples/real/robowflex_fetch.lua --jobs 2
--
-- Scenes whose start or goal touches something for the robot's balls are left out; the script prints their names.

local folder = "vamp_mbm/robots/fetch/"
local fetch = robot.urdf(folder .. "fetch_spherized.urdf", { srdf = folder .. "fetch.srdf", group = "arm_with_torso" })

local problems, invalid = {}, {}
for i = 1, 5 do
  local name = string.format("vicon%04d", i)
  local problem = scenes.load("robowflex_fetch/scene_" .. name .. ".yaml", { robot = fetch, name = name })[1]
  local list = problem.valid and problems or invalid
  list[#list + 1] = problem.valid and problem or name
end
if #invalid > 0 then print("invalid ends: " .. table.concat(invalid, ", ")) end

local planner = rrt_connect { step = 1 }
return experiment {
  problems   = problems,
  strategies = {
    { "rrt_connect", planner },
    { "workspace",   workspace { point = "gripper_link" } >> planner },
  },
  seeds   = 3,
  measure = false,
}
