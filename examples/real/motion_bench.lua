-- SPDX-License-Identifier: MIT-0
-- The problems of MotionBenchMaker for a robot: planning scenes of MoveIt with their requests, in folders such as
-- problems/box_fetch. Used by panda.lua, fetch.lua and baxter.lua.
--
-- They are in the folder of scenes (TRELLIS_SCENES) as archives; unpack them beside this file:
--
--   tar xjf $TRELLIS_SCENES/vamp_mbm/fetch_problems_odd.tar.bz2 -C examples/real

local bench = {}

bench.scenarios = {
  "bookshelf_small", "bookshelf_tall", "bookshelf_thin", "box", "cage", "table_pick", "table_under_pick",
}

-- The problems of some scenarios whose start and goal are valid, named "box/0001"; none where the archive is not
-- unpacked. `number` selects by number.
function bench.found(robot, suffix, scenarios, number)
  local all = {}
  for _, scenario in ipairs(scenarios) do
    for i = 1, 1000 do
      local file = string.format("problems/%s_%s/scene%04d.yaml", scenario, suffix, i)
      if (number == nil or number(i)) and scenes.exists(file) then
        local problem = scenes.load(file, { robot = robot, name = string.format("%s/%04d", scenario, i) })[1]
        if problem.valid then all[#all + 1] = problem end
      end
    end
  end
  return all
end

-- The same; an error where there are none.
function bench.problems(robot, suffix, scenarios, number)
  local all = bench.found(robot, suffix, scenarios, number)
  if #all == 0 then
    local place = string.format("problems/%s_%s", scenarios[1], suffix)
    error("no valid problem in " .. place .. " beside the script; motion_bench.lua says how to unpack the archive", 2)
  end
  return all
end

return bench
