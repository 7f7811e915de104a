return at_most(5).validty_checks()
