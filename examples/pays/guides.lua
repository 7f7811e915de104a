-- SPDX-License-Identifier: MIT-0
-- Guides of the catalogue over one planner, for the scripts that ask which figure ranks them as their costs do:
--
--   local guides = require "pays.guides"
--   strategies = guides.over(rrt, { step = 0.5, proposals = 20000 })

local guides = {}

local function catalogue(space)
  local all = {
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
  }
  if space == "plane" then return all end
  local some = {}
  -- Guides that need a world of the plane, and those that are the same in space as uniform().
  local without = { decomposition = true, holonomic = true, medial_axis = space == "arms" }
  for _, guide in ipairs(all) do
    if not without[guide[1]] then some[#some + 1] = guide end
  end
  return some
end

-- The planner alone, named as such, and each guide over it. `bound = 0`: with a bound the nodes of the root include
-- those of the planner that searches beside it without guides, and a bad guide costs little.
--   planner  a function that makes it, rrt or rrt_connect
--   options  of the planner
--   space    "plane", "space" or "arms": guides that fit there
function guides.over(name, planner, options, space)
  local bounded = { bound = 0 }
  for key, value in pairs(options) do bounded[key] = value end
  local strategies = { { name, planner(options) } }
  for _, guide in ipairs(catalogue(space or "plane")) do
    strategies[#strategies + 1] = { guide[1] .. " >> " .. name, guide[2] >> planner(bounded) }
  end
  return strategies
end

return guides
