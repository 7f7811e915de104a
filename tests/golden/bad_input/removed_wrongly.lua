return lazy_prm { remove = "last" }, scenes.cup()
