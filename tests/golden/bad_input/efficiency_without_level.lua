return has_efficiency(below(2))
