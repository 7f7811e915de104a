local g = lazy()
for _ = 1, 40 do g = g >> (g + g) end
