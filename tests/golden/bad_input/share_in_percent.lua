return solves(at_least(95))
