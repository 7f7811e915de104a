-- SPDX-License-Identifier: MIT-0
-- Which figure ranks guides as their costs do? Guides of the catalogue over rrt, in 14 worlds.
--
--   trellis run examples/correlation.lua --quiet --json nats.json
--   trellis report nats.json --report costs                        prints the rank correlations
--   trellis report nats.json --figures nats --figure correlation   draws them
--
-- docs/measure.md has the results. `bound = 0`: with a bound the nodes of the root include those of the planner that
-- searches beside it without guides, and a bad guide costs little; the nats and the checks would be those of both.

local pays = require "pays.experiment"
local guides = require "pays.guides"

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
  strategies = guides.over("rrt", rrt, { step = 0.5, proposals = 20000 }),
  baseline   = "rrt",
  seeds      = 5,
  measure    = tube { delta = 0.5 },
  ablation   = 0,
}
