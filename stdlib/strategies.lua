-- SPDX-License-Identifier: MIT-0
-- Named strategies
--
-- The methods that Attali et al. 2022 evaluate, with their published parameters (docs/methods.md has what was published
-- and what differs) and one more, then the guides of the methods alone, to be composed with anything, at any level.
-- The RRT of the paper is the planner rrt {}.
--
-- Each takes a table of what shall differ; those that close a strategy have the planner at the root as `planner`:
--
--   strategies.nested { scale = 0.7, planner = rrt_connect {} }
--   0.5*strategies.regions() + 0.5*strategies.relaxation { scales = {0.5} } >> prm {}

local _, native = ...

local strategies = {}

-- Options are described as native.define reads them: lists of groups { COMPONENT, NAME = DEFAULT, ... }, which take
-- their meaning from the component, and of options with a meaning of their own, which have a `name`.

-- The values in `all` of the options that `described` lists.
local function part(all, described)
  local some = {}
  local function pick(entry)
    if entry.name then
      some[entry.name] = all[entry.name]
      return
    end
    for key, value in pairs(entry) do
      if type(key) == "string" then some[key] = all[key] elseif type(value) == "table" then pick(value) end
    end
  end
  pick(described)
  return some
end

-- A function of the given name. `what` has its line of help, its options, perhaps its source, and what it returns if
-- that is no strategy.
local function define(name, what, make)
  strategies[name] = native.define({
    "strategies." .. name, what[1], source = what.source, returns = what.returns or "strategy", usage = what.usage,
    options = what.options,
  }, make)
end

-- The options of every method that ends in an RRT.
local tree = { "rrt", step = 0.5, goal_bias = 0.05 }

-- The planner at the root, instead of `default`.
local function closed_by(default)
  return {
    name = "planner", type = "planner", expects = "a planner", doc = "the planner at the root", default_text = default,
  }
end

local grows = closed_by("an rrt with the step and the shares above")

-- The planner of the searches of smaller robots, and of the root where the strategy is closed.
local every_level = {
  name = "planner", type = "planner", expects = "a planner", default_text = "an rrt with the step and the shares above",
  doc = "the planner of every level. For a robot that is fixed to its base take rrt_connect {}: a single tree seldom "
    .. "reaches the goal of an arm, and thinner links help little",
}

-- `uniform_share` is the share of the whole space beside the guide's. The published methods have no other bound on what
-- their guides spend.
local function grown(o, uniform_share)
  return o.planner or rrt { step = o.step, goal_bias = o.goal_bias, uniform = uniform_share, bound = 0 }
end

-- The methods of the paper ----------------------------------------------------------------------------------------

define("lazy_prm", {
  "a roadmap in the world without obstacles, repaired where its shortest path is blocked",
  source = "Bohlin and Kavraki 2000, Path planning using lazy PRM",
  options = {
    "lazy_prm", samples = 1000, batch = 200, neighbours = 20, remove = "first", edges = "coarse_to_fine", enhance = 1,
    spread = 0.25, proposals = 10000,
  },
}, function(o)
  return lazy_prm(o)
end)

local denny = "Denny, Sandstrom, Bregger and Amato 2016, Dynamic region-biased RRT"
local regions = {
  "skeleton", region = 2, explore = 0.5, decay = 0.9, penetration = 0.5, alignment = 0.1, drop = 1000, emphasis = 1,
}

-- Only the regions: the graph is searched once.
define("regions", {
  "dynamic regions along the skeleton of the workspace: the guide of dr_rrt", source = denny, returns = "guide",
  usage = "strategies.regions() >> shrink(0.5) >> rrt_connect {}", options = regions,
}, function(o)
  o.follow, o.prune, o.resolves = "regions", false, 0
  return skeleton(o)
end)

-- The share of uniform proposals is the whole world's among the regions.
define("dr_rrt", {
  "dynamic regions along the skeleton of the workspace", source = denny, options = { regions, tree, grows },
}, function(o)
  return strategies.regions(part(o, regions)) >> grown(o, 0)
end)

local bayazit = "Bayazit, Xie and Amato 2005, Iterative relaxation of constraints"
local relaxation = {
  {
    name = "scales", type = "number[]", default = {0.25, 0.5, 0.75}, expects = "a list of numbers that grow, below 1",
    doc = "the robots from the smallest to the largest, by the size of the real one",
  },
  { "rrt", step = 0.5, goal_bias = 0.05, uniform = 0.5 },
  { "shrink", radius = 0, evidence = 100, resolves = 10 }, every_level,
}

define("relaxation", {
  "ever larger robots, each guided by the path of the next smaller one: the guide of irc", source = bayazit,
  returns = "guide", usage = "strategies.relaxation { scales = {0.5} } >> prm {}", options = relaxation,
}, function(o)
  if #o.scales == 0 then
    native.fail("strategies.relaxation: field 'scales' must be a list of numbers that grow, below 1")
  end
  local guide
  for i, scale in ipairs(o.scales) do
    local larger = o.scales[i + 1] or 1
    if not (0 < scale and scale < larger) then
      native.fail("strategies.relaxation: field 'scales' must be a list of numbers that grow, below 1")
    end
    local level = shrink {
      scale / larger, follow = "waypoints", keep_tree = true, radius = o.radius, evidence = o.evidence,
      resolves = o.resolves,
      planner = o.planner or rrt { step = o.step, goal_bias = o.goal_bias, uniform = o.uniform, bound = 0 },
    }
    guide = guide and guide >> level or level
  end
  return guide
end)

define("irc", {
  "ever larger robots, each guided by the path of the next smaller one", source = bayazit,
  options = { relaxation, tree },
}, function(o)
  return strategies.relaxation(part(o, relaxation)) >> grown(o, o.uniform)
end)

local vonasek = "Vonasek, Penicka and Kozlikova 2020, Searching multiple approximate solutions"
local several = {
  { "shrink", scale = 0.5, paths = 3, distinct = 0, effort = 2000, radius = 0, evidence = 100, resolves = 10 }, tree,
  every_level,
}

define("several", {
  "several distinct paths of a smaller robot, all guiding at once: the guide of vonasek", source = vonasek,
  returns = "guide", usage = "strategies.several { paths = 2 } >> rrt {}", options = several,
}, function(o)
  return shrink {
    o.scale, follow = "waypoints", paths = o.paths, inhibit = "bottlenecks", distinct = o.distinct,
    effort = o.effort, radius = o.radius,
    evidence = o.evidence, resolves = o.resolves,
    planner = o.planner or rrt { step = o.step, goal_bias = o.goal_bias, uniform = 0.1, bound = 0 },
  }
end)

define("vonasek", {
  "several distinct paths of a smaller robot, all guiding at once", source = vonasek,
  options = { several, { "rrt", uniform = 0.5 } },
}, function(o)
  return strategies.several(part(o, several)) >> grown(o, o.uniform)
end)

-- Beyond the paper ------------------------------------------------------------------------------------------------

define("nested", {
  "skeletons feeding shrunken robots feeding lazy checks",
  options = { { "shrink", scale = 0.5 }, closed_by("rrt { step = 0.5 }") },
  usage = "strategies.nested { scale = 0.7, planner = rrt_connect {} }",
}, function(o)
  return skeleton() >> shrink(o.scale) >> lazy() >> (o.planner or rrt { step = 0.5 })
end)

return strategies
