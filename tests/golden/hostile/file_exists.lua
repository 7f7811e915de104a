return scenes.exists "/etc/shadow"
