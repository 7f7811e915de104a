return solves(0.95)
