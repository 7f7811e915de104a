return has_efficiency("root", above(2), { role = "trees" })
