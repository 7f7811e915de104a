local corners = {}
for i = 1, 500 do corners[i] = { math.cos(i / 500 * 2 * math.pi), math.sin(i / 500 * 2 * math.pi) } end
local shapes = {}
while true do shapes[#shapes + 1] = polygon(corners) end
