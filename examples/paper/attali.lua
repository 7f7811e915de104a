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

-- Every method under its name.
attali.methods = listed({ "rrt", "lazy_prm", "dr_rrt", "irc", "vonasek", "rrt_connect", "nested", "hybrid", "blend" },
  function(name, given) return strategies[name](given) end)

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
  local options = {}
  for option, value in pairs(presets[name]) do options[option] = value end
  for option, value in pairs(given or {}) do options[option] = value end
  return strategies[name](options)
end

-- The paper's own methods, so.
attali.presets = listed({ "rrt", "lazy_prm", "dr_rrt", "irc" }, attali.preset)

return attali
