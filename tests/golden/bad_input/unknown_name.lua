return rrt_conect {}, scenes.cup()
