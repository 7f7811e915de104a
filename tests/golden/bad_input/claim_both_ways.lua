claim { "a does better", problem = "trap", strategy = "a", lower_than = "b", not_lower_than = "b" }
