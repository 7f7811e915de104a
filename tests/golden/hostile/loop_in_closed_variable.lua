local function close()
  local guard <close> = setmetatable({}, { __close = function() while true do end end })
  while true do end
end
while true do pcall(close) end
