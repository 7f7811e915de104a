return split { depth = 2 }, scenes.cup()
