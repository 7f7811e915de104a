local strategy = rrt {}
local here = scenes.cup()
