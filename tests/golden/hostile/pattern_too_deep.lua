return ("x"):rep(1000):find(("(x"):rep(300))
