-- SPDX-License-Identifier: MIT-0
-- The claims of nested.lua, as scenarios.
--
--   trellis test examples/nested_test.lua
--
-- Each expectation is tested on the runs of all seeds, with 95 % confidence; docs/testing.md explains it.

scenario "skeletons that feed shrunken robots that feed lazy checks put more samples near the path" (function()
  local passage = given { script = "nested.lua" }
  local nested, rrt = when { passage.nested, passage.rrt, seeds = 15 }

  expect(nested, solves(at_least(0.95)))
  expect(nested, finds_paths())
  expect(nested, has_efficiency("root", above(rrt), { part = "mass" }))
end)

-- At most a fifth of the checks. Unguided runs vary much between seeds, so many seeds make the interval short.
scenario "what they cost is less than what they save" (function()
  local passage = given { script = "nested.lua" }
  local nested, rrt = when { passage.nested, passage.rrt, seeds = 60 }

  expect(nested, spends(below(rrt).validity_checks()))
end)

scenario "a level that presumes validity checks no motion" (function()
  local passage = given { script = "nested.lua" }
  local nested = when { passage.nested, seeds = 5 }

  expect(nested, spends(exactly(0).motion_checks().in_level("lazy")))
  expect(nested, spends(at_least(1).validity_checks().in_level("skeleton >> shrink")))
end)
