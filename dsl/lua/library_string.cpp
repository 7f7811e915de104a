// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include <dsl/lua/guard.hpp>
#include <dsl/lua/libraries.hpp>
#include <dsl/lua/pattern.hpp>

namespace trellis::lua {

namespace {

constexpr std::size_t bytes_at_once = 16;  // copied in an instruction's time

std::string_view text_argument(lua_State* state, int i) {
  std::size_t size = 0;
  const char* text = luaL_checklstring(state, i, &size);
  return {text, size};
}

void check_length(lua_State* state, std::size_t length) {
  if (length <= Guard::longest_string(state)) return;
  luaL_error(state, "resulting string too large: over %d MiB", static_cast<int>(Guard::longest_string(state) >> 20U));
}

/// Converts a start position that counts from 1, or from the end if negative, to one from 0.
std::size_t place_argument(lua_State* state, int i, std::size_t size) {
  const lua_Integer place = luaL_optinteger(state, i, 1);
  if (place > 0) return static_cast<std::size_t>(place) - 1;
  if (place == 0 || place < -static_cast<lua_Integer>(size)) return 0;
  return size - static_cast<std::size_t>(-place);
}

/// A matcher for a call; its errors become errors of the call.
class Search {
 public:
  Search(lua_State* state, std::string_view text, std::string_view pattern)
      : state_(state),
        text_(text),
        matcher_(text, pattern, [state](std::size_t steps) { Guard::spend(state, steps); }) {}

  /// Returns the end of a match at this position.
  std::size_t match(std::size_t at) {
    return guarded([&] { return matcher_.match(at); });
  }
  void report_work() { matcher_.report_work(); }

  /// Returns the number of values of a match: its captures, or the whole match.
  [[nodiscard]] int values(bool whole) const {
    return matcher_.captures() == 0 && whole ? 1 : static_cast<int>(matcher_.captures());
  }
  /// Pushes one of them.
  void push(std::size_t i, std::size_t begin, std::size_t end) {
    if (i == 0 && matcher_.captures() == 0) {
      lua_pushlstring(state_, text_.data() + begin, end - begin);
      return;
    }
    const Matcher::Capture capture = guarded([&] { return matcher_.capture(i); });
    if (capture.place) {
      lua_pushinteger(state_, static_cast<lua_Integer>(capture.begin) + 1);
    } else {
      lua_pushlstring(state_, text_.data() + capture.begin, capture.length);
    }
  }
  int push_all(std::size_t begin, std::size_t end, bool whole) {
    const int count = values(whole);
    luaL_checkstack(state_, count, "too many captures");
    for (int i = 0; i < count; ++i) push(static_cast<std::size_t>(i), begin, end);
    return count;
  }

 private:
  /// Converts an Error to a Lua error, after the exception handler has ended.
  template <class Body>
  auto guarded(const Body& body) -> decltype(body()) {
    std::optional<decltype(body())> result;
    try {
      result = body();
    } catch (const Error& error) {
      lua_pushstring(state_, error.what());
    }
    if (!result) luaL_error(state_, "%s", lua_tostring(state_, -1));
    return *result;
  }

  lua_State* state_;
  std::string_view text_;
  Matcher matcher_;
};

int find_or_match(lua_State* state, bool find) {
  const std::string_view text = text_argument(state, 1);
  std::string_view pattern = text_argument(state, 2);
  const std::size_t begin = place_argument(state, 3, text.size());
  if (begin > text.size()) {
    luaL_pushfail(state);
    return 1;
  }
  const bool plain =
      find && (lua_toboolean(state, 4) != 0 || pattern.find_first_of("^$*+?.([%-") == std::string_view::npos);
  if (plain) {
    Guard::spend(state, (text.size() - begin + pattern.size()) / bytes_at_once);
    const void* found = pattern.empty() ? text.data() + begin
                                        : ::memmem(text.data() + begin, text.size() - begin, pattern.data(),
                                                   pattern.size());  // linear for all texts
    if (found == nullptr) {
      luaL_pushfail(state);
      return 1;
    }
    const auto at = static_cast<lua_Integer>(static_cast<const char*>(found) - text.data());
    lua_pushinteger(state, at + 1);
    lua_pushinteger(state, at + static_cast<lua_Integer>(pattern.size()));
    return 2;
  }
  const bool anchored = pattern.starts_with('^');
  if (anchored) pattern.remove_prefix(1);
  Search search(state, text, pattern);
  for (std::size_t at = begin; at <= text.size(); ++at) {
    const std::size_t end = search.match(at);
    if (end != Matcher::npos) {
      search.report_work();
      if (!find) return search.push_all(at, end, true);
      lua_pushinteger(state, static_cast<lua_Integer>(at) + 1);
      lua_pushinteger(state, static_cast<lua_Integer>(end));
      return 2 + search.push_all(at, end, false);
    }
    if (anchored) break;
  }
  search.report_work();
  luaL_pushfail(state);
  return 1;
}

int find(lua_State* state) { return find_or_match(state, true); }
int match(lua_State* state) { return find_or_match(state, false); }

/// Returns the next match; upvalues: the text, the pattern, the next position, the end of the last match (-1 at first).
int next_match(lua_State* state) {
  const auto upvalue = [&](int i) {
    std::size_t size = 0;
    const char* text = lua_tolstring(state, lua_upvalueindex(i), &size);
    return std::string_view(text, size);
  };
  constexpr int place = 3, last = 4;
  const std::string_view text = upvalue(1);
  Search search(state, text, upvalue(2));
  const lua_Integer last_end = lua_tointeger(state, lua_upvalueindex(last));
  for (auto at = static_cast<std::size_t>(lua_tointeger(state, lua_upvalueindex(place))); at <= text.size(); ++at) {
    const std::size_t end = search.match(at);
    if (end == Matcher::npos || static_cast<lua_Integer>(end) == last_end) continue;
    search.report_work();
    lua_pushinteger(state, static_cast<lua_Integer>(end));
    lua_copy(state, -1, lua_upvalueindex(place));
    lua_replace(state, lua_upvalueindex(last));
    return search.push_all(at, end, true);
  }
  search.report_work();
  return 0;
}

int gmatch(lua_State* state) {
  const std::string_view text = text_argument(state, 1);
  text_argument(state, 2);
  const std::size_t begin = std::min(place_argument(state, 3, text.size()), text.size() + 1);
  lua_settop(state, 2);
  lua_pushinteger(state, static_cast<lua_Integer>(begin));
  lua_pushinteger(state, -1);
  lua_pushcclosure(state, next_match, 4);
  return 1;
}

/// Appends the replacement of a match; returns whether it differs from the match.
class Replacement {
 public:
  explicit Replacement(lua_State* state) : state_(state), type_(lua_type(state, 3)) {
    const bool known = type_ == LUA_TNUMBER || type_ == LUA_TSTRING || type_ == LUA_TFUNCTION || type_ == LUA_TTABLE;
    luaL_argexpected(state, known, 3, "string/function/table");
    if (type_ == LUA_TNUMBER || type_ == LUA_TSTRING) text_ = text_argument(state, 3);
  }

  bool append(Search& search, std::string_view matched, std::size_t begin, std::string& result) {
    const std::size_t end = begin + matched.size();
    if (type_ == LUA_TFUNCTION) {
      lua_pushvalue(state_, 3);
      const int count = search.push_all(begin, end, true);
      lua_call(state_, count, 1);
    } else if (type_ == LUA_TTABLE) {
      search.push(0, begin, end);
      lua_gettable(state_, 3);
    } else {
      append_text(search, matched, begin, result);
      return true;
    }
    const bool keeps = lua_toboolean(state_, -1) == 0;
    if (!keeps && lua_isstring(state_, -1) == 0) {
      luaL_error(state_, "invalid replacement value (a %s)", luaL_typename(state_, -1));
    }
    std::size_t size = 0;
    const char* text = keeps ? nullptr : lua_tolstring(state_, -1, &size);
    result.append(keeps ? matched : std::string_view(text, size));
    lua_pop(state_, 1);
    return !keeps;
  }

 private:
  void append_text(Search& search, std::string_view matched, std::size_t begin, std::string& result) {
    for (std::size_t i = 0; i < text_.size(); ++i) {
      if (text_[i] != '%') {
        result += text_[i];
        continue;
      }
      const char what = ++i < text_.size() ? text_[i] : '\0';
      if (what == '%') {
        result += '%';
      } else if (what == '0') {
        result += matched;
      } else if (what >= '1' && what <= '9') {
        search.push(static_cast<std::size_t>(what - '1'), begin, begin + matched.size());
        std::size_t size = 0;
        const char* text = luaL_tolstring(state_, -1, &size);
        result.append(text, size);
        lua_pop(state_, 2);
      } else {
        luaL_error(state_, "invalid use of '%%' in replacement string");
      }
      check_length(state_, result.size());
    }
  }

  lua_State* state_;
  int type_;
  std::string_view text_;
};

int gsub(lua_State* state) {
  const std::string_view text = text_argument(state, 1);
  std::string_view pattern = text_argument(state, 2);
  Replacement replacement(state);
  const lua_Integer most = luaL_optinteger(state, 4, static_cast<lua_Integer>(text.size()) + 1);
  const bool anchored = pattern.starts_with('^');
  if (anchored) pattern.remove_prefix(1);
  lua_settop(state, 3);
  Search search(state, text, pattern);
  std::string result;
  bool changed = false;
  lua_Integer count = 0;
  std::size_t at = 0;
  std::size_t last_end = Matcher::npos;
  while (count < most) {
    const std::size_t end = search.match(at);
    if (end != Matcher::npos && end != last_end) {
      ++count;
      const std::size_t before = result.size();
      if (replacement.append(search, text.substr(at, end - at), at, result)) changed = true;
      check_length(state, result.size());
      Guard::spend(state, 1 + (result.size() - before) / bytes_at_once);
      at = last_end = end;
    } else if (at < text.size()) {
      result += text[at++];
    } else {
      break;
    }
    if (anchored) break;
  }
  search.report_work();
  if (!changed) {
    lua_pushvalue(state, 1);
  } else {
    result.append(text.substr(std::min(at, text.size())));
    check_length(state, result.size());
    lua_pushlstring(state, result.data(), result.size());
  }
  lua_pushinteger(state, count);
  return 2;
}

int rep(lua_State* state) {
  const std::size_t size = text_argument(state, 1).size();
  const lua_Integer count = luaL_checkinteger(state, 2);
  std::size_t between = 0;
  luaL_optlstring(state, 3, "", &between);
  if (count <= 0 || size + between == 0) {  // Lua's own repeats an empty string as often
    lua_pushliteral(state, "");
    return 1;
  }
  const auto times = static_cast<std::size_t>(count);
  if (times > Guard::longest_string(state)) check_length(state, times);
  const std::size_t length = times * (size + between) - between;
  check_length(state, length);
  Guard::spend(state, times + length / bytes_at_once);
  return call_replaced(state);
}

}  // namespace

void replace_string(lua_State* state) {
  constexpr std::array<luaL_Reg, 5> functions = {
      {{"find", find}, {"match", match}, {"gmatch", gmatch}, {"gsub", gsub}, {nullptr, nullptr}}};
  luaL_setfuncs(state, functions.data(), 0);
  wrap(state, "rep", rep);
  lua_pushnil(state);
  lua_setfield(state, -2, "dump");
}

}  // namespace trellis::lua
