return 0.5 + lazy(), scenes.cup()
