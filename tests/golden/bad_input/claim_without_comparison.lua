claim { "a does better", problem = "trap", strategy = "a" }
