-- SPDX-License-Identifier: GPL-3.0-or-later
-- Named strategies.
--
-- The methods that Attali et al. 2022 evaluate, with their published parameters (docs/methods.md has the sources):
--
--   strategies.rrt()          no guidance
--   strategies.lazy_prm()     a roadmap in the world without obstacles, repaired where its shortest path is blocked
--   strategies.dr_rrt()       dynamic regions along the skeleton of the workspace
--   strategies.irc()          ever larger robots, each guided by the path of the next smaller one
--   strategies.vonasek()      several distinct paths of a smaller robot, all guiding at once
--
-- The same as the library that the authors used is known to do them: no effective goal bias, regions never dropped:
--
--   strategies.parasol_rrt(), parasol_lazy_prm(), parasol_dr_rrt(), parasol_irc()
--
-- More:
--
--   strategies.rrt_connect()  two trees
--   strategies.nested()       skeletons feeding shrunken robots feeding lazy checks
--   strategies.hybrid()       half of dr_rrt's proposals, half of irc's
--   strategies.blend()        the same guides by what each achieves
--   strategies.skeleton()     the medial axis of the workspace
--   strategies.shrinking()    ever larger robots, by the tubes about their paths
--   strategies.biases()       sampling biases without a space behind them, mixed
--
-- And their guides alone, to be composed with anything, at any level:
--
--   strategies.regions()      of dr_rrt
--   strategies.relaxation()   of irc
--   strategies.several()      of vonasek
--
-- Each takes a table of what shall differ; those that close a strategy have the planner at the root as `planner`:
--
--   strategies.nested { scale = 0.7, planner = rrt_connect {} }
--   0.5*strategies.regions() + 0.5*strategies.relaxation { scales = {0.5} } >> prm {}

local _, native = ...

local strategies = {}

-- Stands for a field that has no value unless it is given.
local none = {}

-- The fields of `given` where it has them, those of `default` elsewhere. A field without a default is a slip.
local function options(name, default, given)
  if given ~= nil and type(given) ~= "table" then
    native.fail("strategies." .. name .. ": takes a table of what shall differ, got " .. tostring(given))
  end
  local fields = {}
  for key, value in pairs(default) do
    if value ~= none then fields[key] = value end
  end
  for key, value in pairs(given or {}) do
    if default[key] == nil then native.fail("strategies." .. name .. ": unknown field '" .. tostring(key) .. "'") end
    fields[key] = value
  end
  return fields
end

local function merged(a, b)
  local all = {}
  for key, value in pairs(a) do all[key] = value end
  for key, value in pairs(b) do all[key] = value end
  return all
end

-- The fields of `all` that `names` has.
local function part(all, names)
  local some = {}
  for key in pairs(names) do some[key] = all[key] end
  return some
end

-- A strategy of the given name and defaults, and the same under parasol_NAME with other defaults.
local function method(name, default, parasol, make)
  strategies[name] = function(given) return make(options(name, default, given)) end
  if parasol then
    local other = "parasol_" .. name
    strategies[other] = function(given) return make(options(other, merged(default, parasol), given)) end
  end
end

-- What every method has that ends in an RRT. `uniform` is the share beside the guide's.
local tree = { step = 0.5, goal_bias = 0.05, planner = none }

local function grown(o, uniform_share)
  return o.planner or rrt { step = o.step, goal_bias = o.goal_bias, uniform = uniform_share }
end

-- The methods of the paper ----------------------------------------------------------------------------------------

method("rrt", { step = 0.5, goal_bias = 0.05 }, { goal_bias = 0 }, function(o)
  return rrt { step = o.step, goal_bias = o.goal_bias }
end)

-- The library checks each edge to its end and adds no nodes near removed edges unless it is told to.
method("lazy_prm", {
  samples = 1000, batch = 200, neighbours = 20, remove = "first", edges = "coarse_to_fine", enhance = 1, spread = 0.25,
  proposals = 10000,
}, { edges = "in_turn", enhance = 0 }, function(o)
  return lazy_prm(o)
end)

local regions = { region = 2, explore = 0.5, decay = 0.9, penetration = 0.5, drop = 1000 }

-- Nothing but the regions: the graph is searched once.
function strategies.regions(given)
  return skeleton(merged(options("regions", regions, given), { resolves = 0 }))
end

-- The share of uniform proposals is the whole world's among the regions.
method("dr_rrt", merged(regions, tree), { goal_bias = 0, penetration = 1, drop = 0 }, function(o)
  return strategies.regions(part(o, regions)) >> grown(o, 0)
end)

local relaxation = {
  scales = {0.25, 0.5, 0.75}, step = 0.5, goal_bias = 0.05, uniform = 0.5, radius = 0, patience = 100, resolves = 10,
}

-- `scales` lists the robots from the smallest to the largest, by the size of the real one.
function strategies.relaxation(given)
  local o = options("relaxation", relaxation, given)
  if type(o.scales) ~= "table" or #o.scales == 0 then
    native.fail("strategies.relaxation: field 'scales' must be a list of numbers that grow, below 1")
  end
  local guide
  for i, scale in ipairs(o.scales) do
    local larger = o.scales[i + 1] or 1
    if type(scale) ~= "number" or type(larger) ~= "number" or not (0 < scale and scale < larger) then
      native.fail("strategies.relaxation: field 'scales' must be a list of numbers that grow, below 1")
    end
    local level = shrink {
      scale / larger, follow = "waypoints", radius = o.radius, patience = o.patience, resolves = o.resolves,
      planner = rrt { step = o.step, goal_bias = o.goal_bias, uniform = o.uniform },
    }
    guide = guide and guide >> level or level
  end
  return guide
end

method("irc", merged(relaxation, tree), { goal_bias = 0 }, function(o)
  return strategies.relaxation(part(o, relaxation)) >> grown(o, o.uniform)
end)

local several = { scale = 0.5, paths = 3, distinct = 0, effort = 2000, step = 0.5, goal_bias = 0.05, radius = 0,
                  patience = 100, resolves = 10 }

function strategies.several(given)
  local o = options("several", several, given)
  return shrink {
    o.scale, follow = "waypoints", paths = o.paths, distinct = o.distinct, effort = o.effort, radius = o.radius,
    patience = o.patience, resolves = o.resolves, planner = rrt { step = o.step, goal_bias = o.goal_bias },
  }
end

method("vonasek", merged(merged(several, { uniform = 0.5 }), tree), nil, function(o)
  return strategies.several(part(o, several)) >> grown(o, o.uniform)
end)

-- Beyond the paper ------------------------------------------------------------------------------------------------

method("rrt_connect", { step = 0.5 }, nil, function(o) return rrt_connect { step = o.step } end)

method("nested", { scale = 0.5, planner = rrt { step = 0.5 } }, nil, function(o)
  return skeleton() >> shrink(o.scale) >> lazy() >> o.planner
end)

-- `share`: of dr_rrt's regions; the rest is irc's.
method("hybrid", merged(merged(regions, relaxation), merged(tree, { share = 0.5, uniform = 0.1 })), nil, function(o)
  local halves = o.share * strategies.regions(part(o, regions))
      + (1 - o.share) * strategies.relaxation(merged(part(o, relaxation), { uniform = 0.5 }))
  return halves >> grown(o, o.uniform)
end)

method("blend", merged(merged(regions, relaxation), merged(tree, {
  floor = 0.2, memory = 0.98, credit = "node", uniform = 0.1,
})), nil, function(o)
  local guides = blend {
    strategies.regions(part(o, regions)),
    strategies.relaxation(merged(part(o, relaxation), { uniform = 0.5 })),
    floor = o.floor, decay = o.memory, credit = o.credit,
  }
  return guides >> grown(o, o.uniform)
end)

method("skeleton", { planner = rrt { step = 0.5 } }, nil, function(o) return skeleton() >> o.planner end)

-- `scales` lists the robots from the smallest to the largest, each by the size of the next.
method("shrinking", { scales = {0.25, 0.5, 0.75}, planner = rrt { step = 0.5 } }, nil, function(o)
  local strategy = o.planner
  for i = #o.scales, 1, -1 do strategy = shrink(o.scales[i]) >> strategy end
  return strategy
end)

method("biases", { planner = rrt { step = 0.5 } }, nil, function(o)
  return (0.5 * uniform() + 0.3 * gaussian() + 0.2 * bridge_test()) >> o.planner
end)

return strategies
