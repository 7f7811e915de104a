local function deep()
  error("no such luck")
end
deep()
