return solves(at_least)
