-- SPDX-License-Identifier: GPL-3.0-or-later
-- Named strategies.
--
--   strategies.nested()       skeletons feeding shrunken robots feeding lazy checks
--   strategies.skeleton()     the medial axis of the workspace
--   strategies.shrinking()    ever larger robots, each guided by the next smaller one
--   strategies.biases()       sampling biases without a space behind them, mixed
--
-- Each takes a table of what shall differ; `planner` is always one of its fields and is the planner at the root:
--
--   strategies.nested { scale = 0.7, planner = rrt_connect {} }

local _, native = ...

local strategies = {}

-- The fields of `given` where it has them, those of `default` elsewhere. A field without a default is a slip.
local function options(name, default, given)
  if given ~= nil and type(given) ~= "table" then
    native.fail("strategies." .. name .. ": takes a table of what shall differ, got " .. tostring(given))
  end
  local fields = {}
  for key, value in pairs(default) do fields[key] = value end
  for key, value in pairs(given or {}) do
    if default[key] == nil then native.fail("strategies." .. name .. ": unknown field '" .. tostring(key) .. "'") end
    fields[key] = value
  end
  return fields
end

function strategies.nested(given)
  local o = options("nested", { scale = 0.5, planner = rrt { step = 0.5 } }, given)
  return skeleton() >> shrink(o.scale) >> lazy() >> o.planner
end

function strategies.skeleton(given)
  local o = options("skeleton", { planner = rrt { step = 0.5 } }, given)
  return skeleton() >> o.planner
end

-- `scales` lists the robots from the smallest to the largest.
function strategies.shrinking(given)
  local o = options("shrinking", { scales = {0.25, 0.5, 0.75}, planner = rrt { step = 0.5 } }, given)
  local strategy = o.planner
  for i = #o.scales, 1, -1 do strategy = shrink(o.scales[i]) >> strategy end
  return strategy
end

function strategies.biases(given)
  local o = options("biases", { planner = rrt { step = 0.5 } }, given)
  return (0.5 * uniform() + 0.3 * gaussian() + 0.2 * bridge_test()) >> o.planner
end

return strategies
