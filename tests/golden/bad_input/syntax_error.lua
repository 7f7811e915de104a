local a = rrt {}
local b = = lazy()
