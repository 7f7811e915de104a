scenario "regions help" (function() end)
