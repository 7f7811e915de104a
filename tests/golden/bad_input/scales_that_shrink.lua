return strategies.irc { scales = {0.75, 0.5} }, scenes.cup()
