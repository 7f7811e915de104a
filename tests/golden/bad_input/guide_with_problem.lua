
return skeleton() >> shrink(0.5), scenes.cup()
