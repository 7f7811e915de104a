-- SPDX-License-Identifier: MIT-0
-- The experiment of Attali et al. 2022, Evaluating Guiding Spaces for Motion Planning: its scenes and its methods.
-- compare.py has its figures. A module of examples/paper.lua and examples/parasol.lua, for scripts in the folder above
-- this one:
--
--   local attali = require "paper.attali"
--
-- The lists of methods take what shall differ for each one, by its name: attali.methods { irc = { scales = {0.5} } }.
-- The methods are those of the module strategies; docs/methods.md states what was published and what differs.

local attali = {}

-- simple_passage, trap and cup.
function attali.scenes() return { scenes.simple_passage(), scenes.trap(), scenes.cup() } end

-- A function that returns a list of pairs, a name and its strategy, as experiment's field 'strategies' takes it.
local function listed(names, make)
  return function(given)
    local known = {}
    for _, name in ipairs(names) do known[name] = true end
    for name in pairs(given or {}) do
      if not known[name] then
        error(("there is no method '%s'; there are: %s"):format(name, table.concat(names, ", ")), 2)
      end
    end
    local list = {}
    for i, name in ipairs(names) do list[i] = { name, make(name, given and given[name]) } end
    return list
  end
end

-- The options in `given`, and those of `default` that it does not have.
local function options_of(default, given)
  local options = {}
  for option, value in pairs(default) do options[option] = value end
  for option, value in pairs(given or {}) do options[option] = value end
  return options
end

-- What is a planner alone, and the mixtures of the guides of dr_rrt and irc, which take options of their rrt: hybrid as
-- Attali et al. 2024 (arXiv 2404.03133) mix them, blend by what each achieves.
local composed = {
  rrt = function(given) return rrt(given or {}) end,
  rrt_connect = function(given) return rrt_connect(given or {}) end,
  hybrid = function(given)
    return 0.5*strategies.regions() + 0.5*strategies.relaxation() >> rrt(options_of({ uniform = 0.1 }, given))
  end,
  blend = function(given)
    local guides = blend { strategies.regions(), strategies.relaxation(), decay = 0.98 }
    return guides >> rrt(options_of({ uniform = 0.1 }, given))
  end,
}
local function method(name, given) return (composed[name] or strategies[name])(given) end

-- Every method under its name.
attali.methods = listed({ "rrt", "lazy_prm", "dr_rrt", "irc", "vonasek", "rrt_connect", "nested", "hybrid", "blend" },
  method)

-- What differs in the library that the authors used: no effective goal bias, regions never dropped, edges checked to
-- their end.
local presets = {
  rrt = { goal_bias = 0 },
  lazy_prm = { edges = "in_turn", enhance = 0 },
  dr_rrt = { goal_bias = 0, penetration = 1, alignment = -1, drop = 0 },
  irc = { goal_bias = 0 },
}

-- A method of the paper as that library does it: attali.preset("irc", { scales = {0.5} }).
function attali.preset(name, given)
  return method(name, options_of(presets[name], given))
end

-- The paper's own methods, so.
attali.presets = listed({ "rrt", "lazy_prm", "dr_rrt", "irc" }, attali.preset)

return attali
