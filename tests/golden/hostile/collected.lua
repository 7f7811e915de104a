local t = {}
for i = 1, 1e6 do t[i] = {} end
while true do collectgarbage() end
