print("guide: " .. lazy())
