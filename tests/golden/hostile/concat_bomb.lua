return table.concat(setmetatable({}, { __index = getmetatable, __metatable = "" }), "", 1, math.maxinteger)
