return ("x"):rep(4e6):byte(1, -1)
