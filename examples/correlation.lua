-- SPDX-License-Identifier: MIT-0
-- Which part of the measure predicts the checks that guidance saves? Guides of the catalogue over rrt, in 14 worlds.
--
--   trellis run examples/correlation.lua --quiet --json nats.json
--   trellis report nats.json --out nats        prints the rank correlations, and draws nats/figures/correlation
--
-- docs/measure.md has the results. `bound = 0`: with a bound the nodes of the root include those of the planner that
-- searches beside it without guides, and a bad guide costs little; the nats and the checks would be those of both.

local pays = require "pays.experiment"

local function tree() return rrt { step = 0.5, proposals = 20000, bound = 0 } end

local strategies = { { "rrt", rrt { step = 0.5, proposals = 20000 } } }
for _, guide in ipairs {
  { "skeleton", skeleton() },
  { "skeleton >> shrink", skeleton() >> shrink(0.5) },
  { "shrink", shrink(0.5) },
  { "workspace", workspace() },
  { "decomposition", decomposition() },
  { "lazy", lazy() },
  { "holonomic", holonomic() },
  { "widen", widen(0.1) },
  { "uniform", uniform() },
  { "halton", halton() },
  { "goal_bias", goal_bias(0.5) },
  { "gaussian", gaussian(0.1) },
  { "obstacle_based", obstacle_based() },
  { "medial_axis", medial_axis() },
} do
  strategies[#strategies + 1] = { guide[1] .. " >> rrt", guide[2] >> tree() }
end

local problems = {}
for _, choice in ipairs {
  { catalogue = true, only = { "paper", "misleading" } },
  { only = { "narrow_gaps_2", "rooms_3", "slalom_8" } },
} do
  for _, group in ipairs(pays.groups(choice)) do
    for _, p in ipairs(group[2]) do problems[#problems + 1] = p end
  end
end

return experiment {
  problems   = problems,
  strategies = strategies,
  baseline   = "rrt",
  seeds      = 5,
  measure    = tube { delta = 0.5 },
  ablation   = 0,
}
