local nothing = polygon {}
return rrt {}, scenes.cup()
