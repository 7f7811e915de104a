local m = require "scene"
