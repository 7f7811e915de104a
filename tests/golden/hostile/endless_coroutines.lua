local function deep() return coroutine.wrap(deep)() end
deep()
