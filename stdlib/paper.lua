-- SPDX-License-Identifier: MIT-0
-- The experiment of Attali et al. 2022: its scenes, its methods, and what goes beyond them
--
-- The lists of methods take what shall differ for each one, by its name: paper.methods { irc = { scales = {0.5} } }.
-- The methods are those of the module strategies; docs/methods.md states what was published and what differs.

local _, native = ...
local strategies = require "strategies"

local paper = {}

local attali = "Attali et al. 2022, Evaluating Guiding Spaces for Motion Planning"

paper.scenes = native.define({
  "paper.scenes", "simple_passage, trap and cup", source = attali, returns = "trellis.Problem[]",
}, function() return { scenes.simple_passage(), scenes.trap(), scenes.cup() } end)

-- The methods of these names, and the functions of the module strategies that they are, as a list of pairs.
local function listed(name, summary, prefix, names)
  local options = {}
  for i, method in ipairs(names) do
    local full = "strategies." .. prefix .. method
    options[i] = {
      name = method, type = "table", expects = "a table of what shall differ", doc = "as " .. full .. " takes it",
    }
  end
  return native.define({
    "paper." .. name, summary, source = attali, returns = "{ [1]: string, [2]: trellis.Strategy }[]",
    usage = "paper." .. name .. " { irc = { scales = {0.5} } }", options = options,
  }, function(given)
    local list = {}
    for i, method in ipairs(names) do list[i] = { prefix .. method, strategies[prefix .. method](given[method]) } end
    return list
  end)
end

paper.methods = listed("methods", "every method under its name, as experiment's 'strategies' takes them", "",
  { "rrt", "lazy_prm", "dr_rrt", "irc", "vonasek", "rrt_connect", "nested", "hybrid", "blend" })

paper.parasol = listed("parasol", "the paper's own methods as the library that the authors used does them", "parasol_",
  { "rrt", "lazy_prm", "dr_rrt", "irc" })

paper.published = native.define({
  "paper.published", "the figures and the sentences of the paper, for experiment's field 'published'",
  source = attali, returns = "trellis.Publication",
}, function()
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
end)

return paper
