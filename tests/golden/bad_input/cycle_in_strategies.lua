local strategies = { plain = rrt {} }
strategies.again = strategies
return experiment { problems = { scenes.cup() }, strategies = strategies }
