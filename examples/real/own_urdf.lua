-- SPDX-License-Identifier: MIT-0
-- A robot of a URDF file among obstacles of one's own: a UR5, as balls, that carries a stick from one side of a post to
-- the other.
--
--   trellis run examples/real/own_urdf.lua
--
-- docs/tutorials/robot.md goes through such a script step by step, with a robot that it writes itself.

local folder = "vamp_mbm/robots/ur5/"
local ur5 = robot.urdf(folder .. "ur5_spherized.urdf", { srdf = folder .. "ur5.srdf", group = "manipulator" })
local stick = cylinder {
  radius = 0.02, length = 0.3, pose = pose {0.2, 0, 0, rpy = {0, math.pi / 2, 0}}, name = "stick",
}
local with = ur5:attach(stick, { link = "wrist_3_link", touch = ur5.links })

local room = world {
  bounds = {-1.2, -1.2, -0.2, 1.2, 1.2, 1.6}, contain = "none",
  cylinder { radius = 0.06, length = 1.6, pose = pose {0.55, 0, 0.8}, name = "post" },
}

return experiment {
  problems = {
    problem {
      name = "past the post", world = room, robot = with,
      start = {0.9, -1.0, 1.2, -1.7, -1.57, 0}, goal = {-0.9, -1.0, 1.2, -1.7, -1.57, 0},
    },
  },
  strategies = {
    { "rrt_connect", rrt_connect { step = 1 } },
    { "workspace",   workspace { point = "wrist_3_link" } >> rrt_connect { step = 1 } },
  },
  seeds   = 5,
  measure = false,
}
