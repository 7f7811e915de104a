return package.loadlib
