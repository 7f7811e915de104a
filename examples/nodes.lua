-- SPDX-License-Identifier: MIT-0
-- A guide that names the node to extend, not only the configuration to extend towards.
--
--   trellis run examples/nodes.lua
--
-- The function that draws may return one result more than C has coordinates: the number of the node to extend, as
-- outcomes have it (`number`, of the node `added`). The planner extends this node, and not the nearest one.
--
-- `patient` extends the node with the least product of its distance from the goal and its number of extensions, in a
-- random direction: straight to the goal where it can, and out of dead ends once their nodes were extended more
-- often than others. The built-in guide `path_database` names nodes by the cost to go that stored paths give them.

local reach = 1 -- metres from the node to the proposal

local function patient()
  local nodes, goal, space, last

  local function priority(node) return (node.distance + 0.1) * (1 + node.extended) end

  return guiding_space {
    name = "patient",
    space = {},
    heuristic = function(_, instance)
      goal, space = instance.goal, instance.space
      nodes = nodes or {}
      return function(random, normal)
        last = nodes[1]
        for _, node in ipairs(nodes) do
          if priority(node) < priority(last) then last = node end
        end
        if not last then
          local lower, upper = space.lower, space.upper
          local function anywhere(i) return lower[i] + random() * (upper[i] - lower[i]) end
          return anywhere(1), anywhere(2), anywhere(3)
        end
        local angle = 2 * math.pi * random()
        local x, y = last.q[1] + reach * math.cos(angle), last.q[2] + reach * math.sin(angle)
        x = math.max(space.lower[1], math.min(space.upper[1], x))
        y = math.max(space.lower[2], math.min(space.upper[2], y))
        return x, y, last.q[3] + 0.3 * normal(), last.number
      end
    end,
    observe = function(outcome)
      if outcome.mine and last then last.extended = last.extended + 1 end
      local q = outcome.added
      if not q or not outcome.number then return end
      nodes[#nodes + 1] = {
        q = { q[1], q[2], q[3] }, number = outcome.number, extended = 0,
        distance = math.sqrt((goal[1] - q[1]) ^ 2 + (goal[2] - q[2]) ^ 2),
      }
    end,
  }
end

return experiment {
  problems   = { scenes.simple_passage(), scenes.cup() },
  strategies = {
    rrt     = rrt { step = 0.5 },
    patient = patient() >> rrt { step = 0.5 },
    -- The same in C++, with cells instead of distances.
    cells   = state_cells() >> rrt { step = 0.5 },
  },
  seeds    = 10,
  baseline = "rrt",
  measure  = false,
}
