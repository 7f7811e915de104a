-- SPDX-License-Identifier: GPL-3.0-or-later
-- Hierarchies of guides spend fewer validity checks, all levels together, than RRT-Connect without guides.

local connect = rrt_connect { step = 0.5 }
local tree = rrt { step = 0.5 }

-- Every strategy solves every run with fewer checks than RRT-Connect: by this share at least.
local function pays(what, world, seeds, share)
  scenario(("hierarchies pay %s"):format(what)) (function()
    local it = given {
      problem = world,
      strategies = {
        planner = connect,
        nested = skeleton() >> shrink(0.5) >> tree,
        nested_connect = skeleton() >> shrink(0.5) >> connect,
        three_levels = skeleton() >> shrink(0.5) >> lazy() >> tree,
      },
    }
    local planner, nested, nested_connect, three_levels =
      when { it.planner, it.nested, it.nested_connect, it.three_levels, seeds = seeds }
    for _, guided in ipairs { nested, nested_connect, three_levels } do
      expect(guided, solves(exactly(1)))
      expect(guided, finds_paths())
      expect(guided, spends(below(planner).validity_checks().by(share)))
    end
  end)
end

pays("in the simple passage", scenes.simple_passage(), 20, 0)
pays("in the trap", scenes.trap(), 15, 0.5)
pays("around the cup", scenes.cup(), 15, 0.5)
pays("in a maze", worlds.maze { cells = 12, seed = 2 }, 6, 0.85)
pays("through rows of false gaps", worlds.false_gaps { rows = 4, kind = "mixed", gaps = 8, seed = 2 }, 15, 0.2)
pays("in rooms", worlds.rooms { rooms = 4, seed = 2 }, 20, 0.5)

-- The medial axis leads through gaps that the robot does not pass. The smaller robot finds that out with fewer checks.
scenario "a smaller robot between the skeleton and the planner pays where gaps are false" (function()
  local it = given {
    problem = worlds.false_gaps { rows = 4, kind = "mixed", gaps = 8, seed = 2 },
    strategies = { alone = skeleton() >> tree, nested = skeleton() >> shrink(0.5) >> tree },
  }
  local alone, nested = when { it.alone, it.nested, seeds = 20 }
  expect(nested, spends(below(alone).validity_checks().by(0.1)))
end)

scenario "a roadmap that validates lazily solves the scenes of the paper" (function()
  for _, scene in ipairs { scenes.simple_passage(), scenes.trap(), scenes.cup() } do
    local it = given { problem = scene, strategies = { roadmap = lazy_prm {} } }
    local roadmap = when { it.roadmap, seeds = 10 }
    expect(roadmap, solves(exactly(1)))
  end
end)
