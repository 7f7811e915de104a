expect(1, solves(at_least(1)))
