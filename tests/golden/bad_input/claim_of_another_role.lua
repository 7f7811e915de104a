claim { "a does better", problem = "trap", strategy = "a", lower_than = "b", roles = "nodes" }
