return rrt {}, scenes.load "/etc/passwd"
