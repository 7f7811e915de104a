local name = ("x"):rep(4e6)
local shapes = {}
while true do shapes[#shapes + 1] = box { 0, 0, 1, 1, name = name } end
