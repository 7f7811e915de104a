return has_efficiency(above(2))
