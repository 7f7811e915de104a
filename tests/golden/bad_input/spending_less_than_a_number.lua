return spends(fewer_than(5).nodes())
