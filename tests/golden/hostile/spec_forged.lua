return rrt.__index, getmetatable(rrt).__gc
