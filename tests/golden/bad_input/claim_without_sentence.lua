claim { problem = "trap", strategy = "a", lower_than = "b" }
