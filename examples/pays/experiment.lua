-- SPDX-License-Identifier: MIT-0
-- Does guidance pay? Its cost beside the best planner without a guide
--
-- scripts/pays runs this experiment world by world; docs/pays.md has what comes out. A module for scripts in the folder
-- above this one:
--
--   local pays = require "pays.experiment"
--   return pays.experiment { only = {"gaps"}, strategies = {"skeleton >> rrt"}, seeds = 5 }

local pays = {}

-- The options of a function, with their defaults; false: none.
local function with_defaults(where, given, defaults)
  for name in pairs(given or {}) do
    if defaults[name] == nil then error(("%s: unknown field '%s'"):format(where, name), 0) end
  end
  local all = {}
  for name, default in pairs(defaults) do
    all[name] = default
    if given and given[name] ~= nil then all[name] = given[name] end
  end
  return all
end

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

-- A world of the robot of the paper, with obstacles that are boxes.
local function of_boxes(name, boxes, start, goal, body)
  local obstacles = {}
  for i, b in ipairs(boxes) do obstacles[i] = box(b) end
  return problem {
    name = name, world = world { bounds = {0, 0, 10, 10}, obstacles }, robot = body or robot.rectangle(0.6, 0.2),
    start = start, goal = goal,
  }
end

local function open_world() return of_boxes("open_world", {}, {1, 5, 0}, {9, 5, 0}) end

-- Small worlds in which guides cost checks.
local function misleading()
  -- Slits that only a point passes; below them there is room.
  local pickets = {}
  for i = 0, 5 do
    local y = 2.5 + i * 1.25
    pickets[i + 1] = {4.8, y, 5.2, i == 5 and 10 or y + 1.13}
  end
  -- Gaps that the robot passes.
  local rows = {}
  for column = 0, 3 do
    for row = 0, 5 do
      local x, y = 3 + column * 1.1, 1.5 + row * 1.2
      rows[#rows + 1] = {x, y, x + 0.7, y + 0.7}
    end
  end
  return {
    -- It needs no guide.
    of_boxes("block", { {4.5, 4.5, 5.5, 5.5} }, {1, 5, 0}, {9, 5, 0}),
    -- A wall 0.1 m thick, with room to pass above it, which widen() removes.
    of_boxes("thin_wall", { {4.95, 0, 5.05, 8.5} }, {1, 3, 0}, {9, 3, 0}),
    -- A wall with a slit that half the robot passes and the robot does not; below it there is room.
    of_boxes("detour", { {4, 1, 6, 4.94}, {4, 5.06, 6, 10} }, {2, 5, 0}, {8, 5, 0}),
    -- Alleys with corners, and a robot that is too long to turn about most of them.
    of_boxes("alleys", { {3, 1, 4.6, 6}, {5, 1, 7, 4.6}, {3, 6.4, 7, 9}, {5, 5, 7, 6} }, {2, 5, 0}, {8, 5, 0},
      robot.rectangle(1.6, 0.2)),
    of_boxes("pickets", pickets, {2, 6, 0}, {8, 6, 0}),
    of_boxes("rows", rows, {1, 5, 0}, {9, 5, 0}),
    worlds.boxes { name = "boxes_120" }, open_world(),
  }
end

-- The plank of the module worlds alone in space.
local function open_space()
  return problem {
    name = "open_space", world = world { bounds = {0, 0, 0, 10, 10, 10} },
    robot = robot.rigid { box {-0.8, -0.5, -0.1, 0.8, 0.5, 0.1} },
    start = pose { 1, 1, 1, axis = {0, 1, 0}, angle = math.pi / 2 },
    goal = pose { 9, 9, 9, axis = {0, 0, 1}, angle = 0 },
  }
end

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
        worlds.floating_boxes { boxes = 150, seed = 2, name = "floating_boxes_150" }, open_space(),
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
  local groups = { { "paper", { scenes.simple_passage(), scenes.trap(), scenes.cup() }, tuned = true } }
  if catalogue then
    groups[2] = { "misleading", misleading() }
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
      worlds.boxes { boxes = 200, seed = 4, size = 0.6, name = "boxes_200" }, open_world(),
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
      error(("%s: there is no '%s'; there are: %s"):format(where, name, table.concat(known, ", ")), 0)
    end
  end
end

-- The worlds, in groups as experiment's field 'groups' takes them: pays.groups { only = {"gaps", "maze_12"} }.
--   only       names of worlds and groups; all of them without it
--   catalogue  worlds for every guide of the catalogue: the paper's scenes, and worlds that mislead
--   mazes      further worlds of the group mazes, a list of problems
--   space      worlds of space; their strategies take steps of a thirtieth of the largest world
function pays.groups(given)
  local o = with_defaults("pays.groups", given, { only = false, catalogue = false, mazes = false, space = false })
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
end

-- The scene files of the group files that are not there.
function pays.missing()
  local missing = {}
  local function look(file) if not scenes.exists(file) then missing[#missing + 1] = file end end
  for _, family in ipairs(families) do
    for _, number in ipairs(images) do look(image_file(family, number)) end
  end
  for _, name in ipairs(dynobench) do look(dynobench_file(name)) end
  for _, entry in ipairs(spatial_files) do look(entry[2]) end
  return missing
end

-- Strategies ------------------------------------------------------------------------------------------------------

local baseline = "rrt_connect"

-- The planners that nothing guides.
--   budget  proposals of the level at the root, after which a run fails
--   step    longest extension of a tree, m in the metric
local function unguided(where, given)
  local o = with_defaults(where, given, { budget = 400000, step = 0.5 })
  local proposals = math.tointeger(o.budget) or math.floor(o.budget)
  return rrt_connect { step = o.step, proposals = proposals }, rrt { step = o.step, proposals = proposals },
    lazy_prm { proposals = proposals }
end

-- Hierarchies of guides, after the planners that nothing guides: pays.strategies { budget = 20000 }.
function pays.strategies(given)
  local connect, tree, roadmap = unguided("pays.strategies", given)
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
end

-- The same for worlds of space: pays.space { step = 1, budget = 20000 }.
function pays.space(given)
  -- lazy_prm takes more than a minute for a run there.
  local connect, tree = unguided("pays.space", given)
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
end

-- Every guide of the catalogue over rrt, after the planners that nothing guides.
function pays.catalogue(given)
  local connect, tree = unguided("pays.catalogue", given)
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
end

-- The experiment --------------------------------------------------------------------------------------------------

-- The worlds and the strategies, beside rrt_connect; nothing is measured but costs:
-- pays.experiment { only = {"paper"}, seeds = 5 }. The options of pays.groups, and
--   strategies  names, of pays.strategies, pays.catalogue or pays.space; the planners that nothing guides are always
--               there
--   seeds       consecutive seeds
--   budget      proposals of the level at the root, after which a run fails
function pays.experiment(given)
  local o = with_defaults("pays.experiment", given, {
    only = false, catalogue = false, mazes = false, space = false, strategies = false, seeds = 30, budget = 400000,
  })
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
end

return pays
