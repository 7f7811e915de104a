-- SPDX-License-Identifier: MIT-0
-- The discs of FibrationTrees (github.com/aorthey/FibrationTrees), whose scenarios are files of YAML; its folder
-- data/scenarios lies in a folder fibration_trees beside this script, or in one that TRELLIS_SCENES names.
--
--   TRELLIS_SCENES=FOLDER trellis run examples/real/fibration_trees.lua

local function scenario(file) return scenes.load("fibration_trees/" .. file .. ".yaml") end

local planner = rrt_connect { bound = 0, proposals = 20000 }
return experiment {
  problems   = { scenario "00_disks/01_DisksInCrossing", scenario "00_disks/02_DisksOnSquare",
                 scenario "00_disks/03_DisksInTee", scenario "01_multirobots_easy/01_MultiDisks_None" },
  strategies = { rrt = rrt { proposals = 20000 }, alone = rrt_connect { proposals = 20000 },
                 prioritise = prioritise() >> planner, couple = couple() >> planner },
  seeds      = 10,
  baseline   = "alone",
  measure    = false,
}
