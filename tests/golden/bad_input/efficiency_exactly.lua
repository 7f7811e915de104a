return has_efficiency("root", exactly(2))
