local scene
print(scene.name)
