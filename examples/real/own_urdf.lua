-- SPDX-License-Identifier: GPL-3.0-or-later
-- A robot of a URDF file among obstacles of one's own: a UR5, as balls, that carries a stick past a post.
--
--   trellis run examples/real/own_urdf.lua
--
-- docs/tutorials/robot.md goes through it step by step.

local folder = "vamp_mbm/robots/ur5/"
local ur5 = robot.urdf(folder .. "ur5_spherized.urdf", { srdf = folder .. "ur5.srdf", group = "manipulator" })
