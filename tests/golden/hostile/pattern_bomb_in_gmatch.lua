for _ in ("a"):rep(4000):gmatch((".-"):rep(20) .. "b") do end
