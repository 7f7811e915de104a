-- SPDX-License-Identifier: GPL-3.0-or-later
-- The experiment of Attali et al. 2022: its scenes, its methods, and what goes beyond them.
--
--   paper.scenes()            simple_passage, trap and cup
--   paper.methods()           every method under its name, as experiment's 'strategies' takes them
--   paper.parasol()           the paper's own as the library that the authors used does them
--   paper.published()         the figures and the sentences of the paper, for experiment's field 'published'
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

function paper.published()
  return published {
    source = "Attali et al. 2022, Evaluating Guiding Spaces for Motion Planning, table 1",
    figures = {
      simple_passage = {
        rrt = {32.147, 18.671}, lazy_prm = {11.395}, dr_rrt = {6.115, 19.845}, irc = {13.797, 19.447},
      },
      trap = {
        rrt = {9.589, 7.547}, lazy_prm = {14.869}, dr_rrt = {38.759, 57.244}, irc = {4.845, 21.612},
      },
      cup = {
        rrt = {8.539, 5.246}, lazy_prm = {6.992}, dr_rrt = {5.834, 18.176}, irc = {3.829, 9.443},
      },
    },
    claims = {
      claim {
        "DR-RRT finds the passage without exploring the region",
        problem = "simple_passage", strategy = "dr_rrt", lower_than = {"rrt", "lazy_prm", "irc"},
      },
      claim {
        "shrinking makes impassable passages seem traversable: IRC does similarly or worse than RRT in Trap",
        problem = "trap", strategy = "irc", not_lower_than = "rrt", roles = {"tree", "expansion"},
      },
      claim {
        "DR-RRT does similarly or worse than RRT in Trap",
        problem = "trap", strategy = "dr_rrt", not_lower_than = "rrt", roles = {"tree", "expansion"},
      },
      claim {
        "LazyPRM does well in Cup",
        problem = "cup", strategy = "lazy_prm", lower_than = "rrt",
      },
    },
  }
end

return paper
