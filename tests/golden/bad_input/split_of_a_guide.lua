return split { skeleton() } , scenes.cup()
