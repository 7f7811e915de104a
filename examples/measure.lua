-- SPDX-License-Identifier: MIT-0
-- The targets of the sampling efficiency, its estimators, and the contribution of each guide of a strategy.
--
--   trellis run examples/measure.lua
--   trellis run examples/measure.lua --cross 0          each run on its own path only
--   trellis help tube      trellis help target      trellis help knn      trellis help experiment
--
-- The sampling efficiency is the divergence, in nats, of the samples from a target distribution T of useful samples.
-- Reports print nats above uniform sampling: by how much that divergence is smaller; more is better.

local targets = {
  -- T uniform within 0.5 m of the path that the run found. The default.
  tube = tube { delta = 0.5 },
  -- T uniform on the configurations of paths of at most 1.2 times the optimal length.
  near_optimal = near_optimal { epsilon = 0.2 },
  -- T uniform on the motions that make progress towards the goal.
  progress = progress { step = 0.5 },
}

-- A user-defined target: the narrow passage, wherever the path leads. `sample` draws from T; `log_density` is the
-- logarithm of T's density with respect to volume in metric coordinates, where an angle counts 1 / pi metres a radian.
local lower, upper = {4, 4.85, -0.3}, {6, 5.15, 0.3}

local function log_volume(space)
  local sum = 0
  for i = 1, space.dimension do sum = sum + math.log((upper[i] - lower[i]) * space.weights[i]) end
  return sum
end

targets.passage = target {
  sample = function(context)
    local q = {}
    for i = 1, context.space.dimension do q[i] = lower[i] + (upper[i] - lower[i]) * context.random() end
    return q
  end,
  log_density = function(q, context)
    for i, x in ipairs(q) do
      if x < lower[i] or x > upper[i] then return -math.huge end
    end
    return -log_volume(context.space)
  end,
  delta = 0.25,   -- the radius of coverage by a sample
  points = 1024,  -- a script's functions are slower than Trellis's own: 1024 points suffice
  pool = 2048,
}

return experiment {
  problems   = scenes.simple_passage(),
  strategies = {
    rrt    = rrt { step = 0.5 },
    nested = skeleton() >> shrink(0.5) >> rrt { step = 0.5 },
  },
  seeds      = 3,
  measure    = targets.passage,                   -- or targets.tube, targets.near_optimal, targets.progress
  estimators = { exact(), knn {} }, -- the first that has a value gives the headline
  cross      = 2,                                 -- score each run on the targets of two other seeds as well
  baseline   = "rrt",                             -- the reference of the comparisons
  ablate     = { "nested" },                      -- adds this strategy without each of its guides
}
