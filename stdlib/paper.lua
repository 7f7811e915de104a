-- SPDX-License-Identifier: GPL-3.0-or-later
-- The experiment of Attali et al. 2022: its scenes, its methods, and what goes beyond them.
--
--   paper.scenes()            simple_passage, trap and cup
--   paper.methods()           every method under its name, as experiment's 'strategies' takes them
--   paper.parasol()           the paper's own as the library that the authors used does them
--
-- The last two take what shall differ for each method, by its name: paper.methods { irc = { scales = {0.5} } }.
-- The methods are those of the module strategies; docs/methods.md tells what was published and what differs.

local _, native = ...
local strategies = require "strategies"

local paper = {}

function paper.scenes()
  return { scenes.simple_passage(), scenes.trap(), scenes.cup() }
end

-- The named methods as a list of pairs.
local function listed(what, prefix, names, given)
  if given ~= nil and type(given) ~= "table" then
    native.fail(what .. ": takes a table of what shall differ for each method, got " .. tostring(given))
  end
  local list, known = {}, {}
  for i, name in ipairs(names) do
    list[i] = { prefix .. name, strategies[prefix .. name](given and given[name]) }
    known[name] = true
  end
  for name in pairs(given or {}) do
    if not known[name] then
      native.fail(what .. ": unknown method '" .. tostring(name) .. "'; there are: " .. table.concat(names, ", "))
    end
  end
  return list
end

function paper.methods(given)
  return listed("paper.methods", "",
    { "rrt", "lazy_prm", "dr_rrt", "irc", "vonasek", "rrt_connect", "nested", "hybrid", "blend" }, given)
end

function paper.parasol(given)
  return listed("paper.parasol", "parasol_", { "rrt", "lazy_prm", "dr_rrt", "irc" }, given)
end

return paper
