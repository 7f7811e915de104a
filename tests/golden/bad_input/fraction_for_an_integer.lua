return prm { neighbours = 2.5 }, scenes.cup()
