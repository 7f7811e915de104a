-- SPDX-License-Identifier: MIT-0
-- Guides that mislead, without a bound and with the default bound of 2, by which a run costs at most twice what its
-- planner costs alone on that seed, and a constant (864 checks). See docs/language.md, "What happens at each level".

local open = problem {
  name = "open",
  world = world { bounds = { 0, 0, 10, 10 } },
  robot = robot.rectangle(1, 0.2),
  start = { 1, 1, 0 }, goal = { 9, 9, 1 },
}

-- A path of valid motion near the start that leads nowhere.
local zigzag = guiding_space {
  name = "zigzag",
  space = {},
  heuristic = function(_, instance)
    local start = instance.start
    return function(random)
      return start[1] + random(), start[2] + random(), start[3] + 0.1 * random()
    end
  end,
}

local function sum(n)
  local parts = shrink(0.5)
  for _ = 2, n do parts = parts + shrink(0.5) end
  return parts
end

local free = rrt { bound = 0 }
local strategies = { rrt = rrt {} }
for _, n in ipairs { 1, 5, 20 } do
  strategies["shrink x " .. n] = sum(n) >> rrt {}
  strategies["shrink x " .. n .. ", no bound"] = sum(n) >> free
end
strategies["zigzag"] = zigzag >> rrt {}
strategies["zigzag, no bound"] = zigzag >> free
strategies["skeleton >> shrink"] = skeleton() >> shrink(0.5) >> rrt {}
strategies["skeleton >> shrink, no bound"] = skeleton() >> shrink(0.5) >> free

return experiment {
  problems = { open, scenes.simple_passage(), scenes.cup() },
  strategies = strategies,
  seeds = 20,
}
