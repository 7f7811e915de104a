-- SPDX-License-Identifier: GPL-3.0-or-later
-- Does guidance pay? The costs of guided strategies beside RRT-Connect without guides, in rows of false gaps.
--
--   trellis run examples/pays.lua --json costs.json
--   trellis compare costs.json --out costs       prints ratios, and writes tables and figures
--
-- scripts/pays does so with every world and strategy; docs/pays.md has what comes out.

return pays.experiment {
  only       = {"gaps"},
  strategies = {"skeleton >> rrt", "shrink >> rrt", "skeleton >> shrink >> rrt"},
  seeds      = 10,
}
