-- SPDX-License-Identifier: MIT-0
-- Does guidance pay? The costs of guided strategies relative to RRT-Connect without guides, in rows of false gaps.
--
--   trellis run examples/pays.lua --json costs.json
--   trellis report costs.json --report costs --figures costs   prints ratios, writes figures and tables
--
-- scripts/pays does this with every world and strategy; docs/pays.md has the results.

local pays = require "pays.experiment"

return pays.experiment {
  only       = {"gaps"},
  strategies = {"skeleton >> rrt", "shrink >> rrt", "skeleton >> shrink >> rrt"},
  seeds      = 10,
}
