local it = given { script = "doorway.lua" }
