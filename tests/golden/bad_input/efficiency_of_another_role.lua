return has_efficiency("root", below(2), { role = "trees" })
