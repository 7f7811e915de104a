local text = ("a"):rep(200)
return text:find(("a*"):rep(30) .. "b")
