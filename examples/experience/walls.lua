-- SPDX-License-Identifier: MIT-0
-- The worlds of learn.lua and use.lua: two walls with a narrow gap each, and further obstacles.

return function(...)
  return world {
    bounds = {0, 0, 10, 10},
    box {3, 0, 3.5, 1.2}, box {3, 1.7, 3.5, 10},
    box {6.5, 0, 7, 1.2}, box {6.5, 1.7, 7, 10},
    ...
  }
end
