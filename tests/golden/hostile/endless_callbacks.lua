local function deep() return (("x"):gsub("x", deep)) end
deep()
