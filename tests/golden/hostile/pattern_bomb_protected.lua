while true do
  pcall(string.gsub, ("a"):rep(2000), (".-"):rep(20) .. "b", "")
end
