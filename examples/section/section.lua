-- SPDX-License-Identifier: MIT-0
-- The experiment section of a paper: what does each guide save, at which scale of the smaller robot, and is it shown?
--
--   examples/section/figures FOLDER
--
-- draws and tabulates all of it. Replace the problems by your own, the strategies by what you compare.
local step = 0.5
local tree = rrt { step = step }
local strategies = {
  { "RRT", tree },
  { "RRT-Connect", rrt_connect { step = step } },
  { "skeleton", skeleton() >> tree },
  { "skeleton, lazy", skeleton() >> lazy() >> tree },
}
-- Strategies that differ in one number are a curve over it: the figure `sweep`.
for _, scale in ipairs { 0.2, 0.4, 0.6, 0.8, 1 } do
  strategies[#strategies + 1] = { "shrink " .. scale, skeleton() >> shrink(scale) >> tree }
end

return experiment {
  problems   = {
    scenes.simple_passage(),
    scenes.trap(),
    worlds.false_gaps { rows = 4, gaps = 8, kind = "mixed", seed = 2 },
  },
  strategies = strategies,
  baseline   = "RRT",
  seeds      = 15,
  measure    = tube { delta = 0.5 },
}
