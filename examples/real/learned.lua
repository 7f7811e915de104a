-- SPDX-License-Identifier: MIT-0
-- A heuristic learnt from other worlds: it predicts near-optimal paths from features that need no search.
--
--   trellis experience --data SCENES/mp_datasets --family gaps_and_forest --out examples/real/gaps_and_forest.model
--   trellis run examples/real/learned.lua
--
-- SCENES is the folder of benchmark scenes. Training uses cells of the family's 60 worlds and the
-- results of an oracle that searches each world exactly; it prints the model's performance on the worlds of the
-- validation split, which are not in the training data. The script runs on worlds of that split: three of the family,
-- and three of another one, to which the model does not apply.

local problems = {}
for _, family in ipairs { "gaps_and_forest", "single_bugtrap" } do
  for i = 800, 802 do
    problems[#problems + 1] = scenes.load(("mp_datasets/%s/validation/%d.png"):format(family, i))
  end
end

return experiment {
  problems = problems,
  strategies = {
    rrt = rrt { step = 0.5 },
    learned = learned { model = "gaps_and_forest.model" } >> rrt { step = 0.5 },
  },
  baseline = "rrt",
  seeds = 30,
}
