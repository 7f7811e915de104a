-- SPDX-License-Identifier: MIT-0
-- Does guidance pay? Its cost beside the best planner without a guide
--
-- scripts/pays runs this experiment world by world; docs/pays.md has what comes out. A part of it is a script of two
-- lines:
--
--   return pays.experiment { only = {"gaps"}, strategies = {"skeleton >> rrt"}, seeds = 5 }

local _, native = ...

local pays = {}

-- Worlds ----------------------------------------------------------------------------------------------------------

local families = {
  "alternating_gaps", "bugtrap_forest", "forest", "gaps_and_forest", "mazes", "multiple_bugtraps", "shifting_gaps",
  "single_bugtrap",
}
local images = { 800, 801 }
local dynobench = {
  "car1_v0/kink_0", "car1_v0/parallelpark_0", "quad2d_v0/quad2d_recovery_obs", "quad2d_v0/quad_obs_column",
  "unicycle1_v0/bugtrap_0", "unicycle1_v0/parallelpark_0", "unicycle1_v1/kink_0", "unicycle2_v0/kink_0",
}

local function image_file(family, number) return ("mp_datasets/%s/validation/%d.png"):format(family, number) end
local function dynobench_file(name) return "dynobench/" .. name .. ".yaml" end

-- Worlds from existing files. An image has no robot: the paper's robot crosses it from corner to corner.
local function from_files()
  local all = {}
  for _, family in ipairs(families) do
    for _, number in ipairs(images) do
      local file = image_file(family, number)
      if scenes.exists(file) then
        all[#all + 1] = problem {
          name = family .. "_" .. number, world = scenes.load(file)[1].world, robot = robot.rectangle(0.6, 0.2),
          start = {0.5, 0.5, math.pi / 4}, goal = {9.5, 9.5, math.pi / 4},
        }
      end
    end
  end
  for _, name in ipairs(dynobench) do
    local file = dynobench_file(name)
    if scenes.exists(file) then
      for _, p in ipairs(scenes.load(file, { motion = false })) do all[#all + 1] = p end
    end
  end
  return all
end

local spatial_files = {
  { "box_in_maze", "rl/rlplan/box-6d-300505_maze_rrtConCon.mdl.sixDof.xml", {} },
  { "hook", "open_ppl/hook/hook.env", { resolution = 1, weight = 40 } },
}

-- Worlds of space. None was used to tune a strategy.
local function spatial_groups()
  local groups = {
    {
      "space",
      {
        worlds.slot {}, worlds.windows { walls = 1, name = "windows_1" }, worlds.windows { name = "windows_2" },
        worlds.floating_boxes { name = "floating_boxes_60" },
        worlds.floating_boxes { boxes = 150, seed = 2, name = "floating_boxes_150" }, worlds.open_space(),
      },
    },
  }
  local files = {}
  for _, entry in ipairs(spatial_files) do
    if scenes.exists(entry[2]) then
      local p = scenes.load(entry[2], entry[3])[1]
      files[#files + 1] = problem {
        name = entry[1], world = p.world, robot = p.robot, start = p.start, goal = p.goal, resolution = p.resolution,
        weight = entry[3].weight,
      }
    end
  end
  if #files > 0 then groups[#groups + 1] = { "files", files } end
  return groups
end

-- The strategies were tuned on the groups with `tuned`; the other groups are held out.
local function all_groups(catalogue, mazes, space)
  if space then return spatial_groups() end
  local groups = { { "paper", paper.scenes(), tuned = true } }
  if catalogue then
    groups[2] = {
      "misleading",
      {
        worlds.block(), worlds.thin_wall(), worlds.detour(), worlds.alleys(), worlds.pickets(), worlds.rows(),
        worlds.boxes { name = "boxes_120" }, worlds.open_world(),
      },
    }
    return groups
  end
  local all_mazes = {
    worlds.maze { cells = 6, seed = 1, name = "maze_6" }, worlds.maze { cells = 12, seed = 2, name = "maze_12" },
    worlds.maze { cells = 20, seed = 3, name = "maze_20" },
  }
  for _, maze in ipairs(mazes or {}) do all_mazes[#all_mazes + 1] = maze end
  groups[#groups + 1] = { "mazes", all_mazes, tuned = true }
  groups[#groups + 1] = {
    "gaps",
    {
      worlds.false_gaps { rows = 2, kind = "narrow", name = "narrow_gaps_2" },
      worlds.false_gaps { rows = 6, kind = "narrow", name = "narrow_gaps_6" },
      worlds.false_gaps { rows = 2, kind = "bent", name = "bent_gaps_2" },
      worlds.false_gaps { rows = 6, kind = "bent", name = "bent_gaps_6" },
      worlds.false_gaps { rows = 4, kind = "mixed", gaps = 8, seed = 2, name = "mixed_gaps_4" },
    },
  }
  groups[#groups + 1] = {
    "rooms",
    {
      worlds.rooms { rooms = 3, name = "rooms_3" }, worlds.rooms { rooms = 4, seed = 2, name = "rooms_4" },
      worlds.rooms { rooms = 6, seed = 3, name = "rooms_6" },
    },
  }
  groups[#groups + 1] = {
    "other",
    {
      worlds.bug_trap(), worlds.slalom { name = "slalom_8" }, worlds.boxes { name = "boxes_120" },
      worlds.boxes { boxes = 200, seed = 4, size = 0.6, name = "boxes_200" }, worlds.open_world(),
      worlds.dead_ends { name = "dead_ends_4" }, worlds.dead_ends { pockets = 8, name = "dead_ends_8" },
    },
  }
  local files = from_files()
  if #files > 0 then groups[#groups + 1] = { "files", files } end
  return groups
end

-- Whether a list of names contains this one; ignores blanks. `found` records the matched names.
local function chosen(names, name, found)
  if not names then return true end
  for _, wanted in ipairs(names) do
    if wanted:gsub("%s", "") == name:gsub("%s", "") then
      found[wanted] = true
      return true
    end
  end
  return false
end

local function require_found(where, names, found, known)
  for _, name in ipairs(names or {}) do
    if not found[name] then
      native.fail(("%s: there is no '%s'; there are: %s"):format(where, name, table.concat(known, ", ")))
    end
  end
end

local choice = {
  {
    name = "only", type = "string[]", expects = "a list of names", doc = "worlds and groups; all of them without it",
  },
  {
    name = "catalogue", type = "boolean", default = false, expects = "true or false",
    doc = "every guide of the catalogue over rrt, on the paper's scenes and on worlds that mislead",
  },
  {
    name = "mazes", type = "trellis.Problem[]", expects = "a list of problems",
    doc = "further worlds of the group mazes",
  },
  {
    name = "space", type = "boolean", default = false, expects = "true or false",
    doc = "worlds of space; their strategies take steps of a thirtieth of the largest world",
  },
}

pays.groups = native.define({
  "pays.groups", "the worlds, in groups as experiment's field 'groups' takes them", returns = "table[]",
  usage = "pays.groups { only = {\"gaps\", \"maze_12\"} }", options = choice,
}, function(o)
  local groups, found, known = {}, {}, {}
  for _, group in ipairs(all_groups(o.catalogue, o.mazes, o.space)) do
    local name, whole, some = group[1], chosen(o.only, group[1], found), {}
    known[#known + 1] = name
    for _, p in ipairs(group[2]) do
      if chosen(o.only, p.name, found) or whole then some[#some + 1] = p end
      known[#known + 1] = p.name
    end
    if #some > 0 then groups[#groups + 1] = { name, some, tuned = group.tuned or false } end
  end
  require_found("pays.groups: field 'only'", o.only, found, known)
  return groups
end)

pays.missing = native.define({
  "pays.missing", "the scene files of the group files that are not there", returns = "string[]",
}, function()
  local missing = {}
  local function look(file) if not scenes.exists(file) then missing[#missing + 1] = file end end
  for _, family in ipairs(families) do
    for _, number in ipairs(images) do look(image_file(family, number)) end
  end
  for _, name in ipairs(dynobench) do look(dynobench_file(name)) end
  for _, entry in ipairs(spatial_files) do look(entry[2]) end
  return missing
end)

-- Strategies ------------------------------------------------------------------------------------------------------

local budget = {
  name = "budget", unit = "proposals", default = 400000, lo = 1, hi = 1e9,
  doc = "proposals of the level at the root, after which a run fails",
}

local baseline = "rrt_connect"

local step = {
  name = "step", unit = "m in the metric", default = 0.5, lo = 1e-6, hi = 1e9, doc = "longest extension of a tree",
}

local function unguided(o)
  local proposals = math.tointeger(o.budget) or math.floor(o.budget)
  return rrt_connect { step = o.step, proposals = proposals }, rrt { step = o.step, proposals = proposals },
    lazy_prm { proposals = proposals }
end

pays.strategies = native.define({
  "pays.strategies", "hierarchies of guides, after the planners that nothing guides",
  returns = "{ [1]: string, [2]: trellis.Strategy }[]", usage = "pays.strategies { budget = 20000 }",
  options = { budget, step },
}, function(o)
  local connect, tree, roadmap = unguided(o)
  return {
    { "rrt_connect", connect },
    { "rrt", tree },
    { "lazy_prm", roadmap },
    { "skeleton >> rrt", skeleton() >> tree },
    { "shrink >> rrt", shrink(0.5) >> tree },
    { "lazy >> rrt", lazy() >> tree },
    { "skeleton >> shrink >> rrt", skeleton() >> shrink(0.5) >> tree },
    { "skeleton >> lazy >> rrt", skeleton() >> lazy() >> tree },
    { "lazy >> lazy >> rrt", lazy() >> lazy() >> tree },
    { "skeleton >> shrink >> lazy >> rrt", skeleton() >> shrink(0.5) >> lazy() >> tree },
    { "skeleton >> rrt_connect", skeleton() >> connect },
    { "shrink >> rrt_connect", shrink(0.5) >> connect },
    { "lazy >> rrt_connect", lazy() >> connect },
    { "skeleton >> shrink >> rrt_connect", skeleton() >> shrink(0.5) >> connect },
    { "skeleton >> lazy_prm", skeleton() >> roadmap },
  }
end)

pays.space = native.define({
  "pays.space", "hierarchies of guides for worlds of space, after the planners that nothing guides",
  returns = "{ [1]: string, [2]: trellis.Strategy }[]", usage = "pays.space { step = 1, budget = 20000 }",
  options = { budget, step },
}, function(o)
  -- lazy_prm takes more than a minute for a run there.
  local connect, tree = unguided(o)
  local all = { { "rrt_connect", connect }, { "rrt", tree } }
  for _, guide in ipairs {
    { "workspace", workspace() }, { "skeleton", skeleton() }, { "decomposition", decomposition() },
    { "shrink", shrink(0.5) }, { "lazy", lazy() },
    { "workspace >> shrink", workspace() >> shrink(0.5) }, { "skeleton >> shrink", skeleton() >> shrink(0.5) },
    { "workspace >> shrink >> lazy", workspace() >> shrink(0.5) >> lazy() },
  } do
    all[#all + 1] = { guide[1] .. " >> rrt_connect", guide[2] >> connect }
  end
  return all
end)

pays.catalogue = native.define({
  "pays.catalogue", "every guide of the catalogue over rrt, after the planners that nothing guides",
  returns = "{ [1]: string, [2]: trellis.Strategy }[]", usage = "pays.catalogue { budget = 20000 }",
  options = { budget, step },
}, function(o)
  local connect, tree = unguided(o)
  local guides = {
    { "shrink", shrink(0.5) },
    { "workspace", workspace() },
    { "skeleton", skeleton() },
    { "decomposition", decomposition() },
    { "holonomic", holonomic() },
    { "blossom", blossom() },
    { "joints", joints { "x", "y" } },
    { "pca", pca(2) },
    { "widen", widen(0.1) },
    { "lazy", lazy() },
    { "drop", drop() },
    { "aggregate", aggregate() },
    { "identity", identity() },
    { "uniform", uniform() },
    { "goal_bias", goal_bias(0.9) },
    { "gaussian", gaussian(0.1) },
    { "bridge_test", bridge_test(0.6) },
    { "obstacle_based", obstacle_based() },
    { "medial_axis", medial_axis() },
    { "halton", halton() },
    { "informed", informed { cost = 13 } },
    { "information_gain", information_gain() },
    { "state_cells", state_cells() },
    { "skeleton >> shrink", skeleton() >> shrink(0.5) },
    { "skeleton + lazy", 0.5 * skeleton() + 0.5 * lazy() },
    { "skeleton .. lazy", skeleton() .. lazy() },
    { "blend", blend { skeleton(), lazy() } },
    { "schedule", schedule { shrink(0.4), shrink(0.8) } },
    { "race", race { shrink(0.9), skeleton() >> shrink(0.6) } },
  }
  local all = { { "rrt_connect", connect }, { "rrt", tree } }
  for _, guide in ipairs(guides) do all[#all + 1] = { guide[1] .. " >> rrt", guide[2] >> tree } end
  all[#all + 1] = { "skeleton >> split(rrt)", skeleton() >> split { tree } }
  return all
end)

-- The experiment --------------------------------------------------------------------------------------------------

pays.experiment = native.define({
  "pays.experiment", "the worlds and the strategies, beside rrt_connect; nothing is measured but costs",
  returns = "trellis.Experiment", usage = "pays.experiment { only = {\"paper\"}, seeds = 5 }",
  options = {
    choice,
    {
      name = "strategies", type = "string[]", expects = "a list of names",
      doc = "of pays.strategies, pays.catalogue or pays.space; the planners that nothing guides are always there",
    },
    { name = "seeds", unit = "seeds", default = 30, lo = 1, hi = 1e6, doc = "consecutive seeds" },
    budget,
  },
}, function(o)
  local groups = pays.groups { only = o.only, catalogue = o.catalogue, mazes = o.mazes, space = o.space }
  local largest = 0
  for _, group in ipairs(o.space and groups or {}) do
    for _, p in ipairs(group[2]) do
      local b = p.world.bounds
      for axis = 1, 3 do largest = math.max(largest, b[axis + 3] - b[axis]) end
    end
  end
  local common = { budget = o.budget, step = o.space and largest / 30 or nil }
  local all = o.space and pays.space(common) or o.catalogue and pays.catalogue(common) or pays.strategies(common)
  local some, found, known = {}, {}, {}
  for _, strategy in ipairs(all) do
    local alone = not strategy[1]:find(">>", 1, true)
    if chosen(o.strategies, strategy[1], found) or alone then some[#some + 1] = strategy end
    known[#known + 1] = strategy[1]
  end
  require_found("pays.experiment: field 'strategies'", o.strategies, found, known)
  local problems = {}
  for _, group in ipairs(groups) do problems[#problems + 1] = group[2] end
  return experiment {
    problems = problems, groups = groups, strategies = some, baseline = baseline,
    seeds = math.tointeger(o.seeds) or math.floor(o.seeds), measure = false, ablation = 0,
  }
end)

return pays
