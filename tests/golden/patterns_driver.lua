-- SPDX-License-Identifier: GPL-3.0-or-later
-- Texts and patterns, and what the functions of strings make of them: the same in Lua and as a script of Trellis.
local state = 12345
local function random(n)
  state = (state * 1103515245 + 12345) % 2147483648
  return state // 65536 % n + 1
end
local function pick(list) return list[random(#list)] end

local letters = { "a", "b", "c", " ", "(", ")", "1", "%", "]", "-" }
local singles = {
  "a", "b", "c", ".", "%a", "%s", "%d", "%w", "%A", "%%", "[ab]", "[^a]", "[a-c]", "[]a]", "[^]]", "[%a-]", "[a-]",
  "%(", "-", "]",
}
local suffixes = { "", "", "", "*", "+", "-", "?" }
local function text()
  local s = ""
  for _ = 1, random(9) - 1 do s = s .. pick(letters) end
  return s
end
local function pattern()
  local p = random(6) == 1 and "^" or ""
  for _ = 1, random(5) do
    local kind = random(16)
    if kind <= 10 then
      p = p .. pick(singles) .. pick(suffixes)
    elseif kind == 11 then
      p = p .. "(" .. pick(singles) .. pick(suffixes) .. ")"
    elseif kind == 12 then
      p = p .. "()"
    elseif kind == 13 then
      p = p .. "%b()"
    elseif kind == 14 then
      p = p .. "%f" .. pick { "[a]", "[^a]", "[%w]", "a" }
    elseif kind == 15 then
      p = p .. pick { "%1", "%2", "(", ")", "[", "%", "%b(", "[a", "$" }
    else
      p = p .. "(" .. pick(singles) .. "(" .. pick(singles) .. "))"
    end
  end
  return random(6) == 1 and p .. "$" or p
end
local function told(good, ...)
  if not good then return "error" end
  local parts = {}
  for i = 1, select("#", ...) do parts[i] = tostring((select(i, ...))) end
  return table.concat(parts, ",")
end
local function all(s, p)
  local parts = {}
  for a, b in s:gmatch(p) do parts[#parts + 1] = tostring(a) .. ":" .. tostring(b) end
  return table.concat(parts, ",")
end

local lines = {}
for _ = 1, 1500 do
  local s, p, from = text(), pattern(), random(5) - 3
  local found = {
    told(pcall(string.find, s, p, from)),
    told(pcall(string.match, s, p, from)),
    told(pcall(all, s, p)),
    told(pcall(string.gsub, s, p, "<%0>")),
    told(pcall(string.gsub, s, p, "<%1>", 2)),
    told(pcall(string.gsub, s, p, function(a, b) return b and a .. b end)),
    told(pcall(string.find, s, p, 1, true)),
  }
  lines[#lines + 1] = s .. " ~ " .. p .. " ~ " .. from .. " ~ " .. table.concat(found, " ~ ")
end
return table.concat(lines, "\n") .. "\n"
