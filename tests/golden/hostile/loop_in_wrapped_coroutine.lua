local function deep(n)
  while true do
    pcall(coroutine.wrap(function() if n > 0 then deep(n - 1) else while true do end end end))
  end
end
deep(20)
