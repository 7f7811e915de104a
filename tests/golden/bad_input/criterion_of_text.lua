return at_least "much"
