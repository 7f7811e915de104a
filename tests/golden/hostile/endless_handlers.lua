local function deep() error("again") end
xpcall(deep, deep)
local function again() return xpcall(again, again) end
return again()
