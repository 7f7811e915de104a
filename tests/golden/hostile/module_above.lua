return require "...etc.passwd"
