// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/pattern.hpp>

#include <fmt/format.h>

#include <cctype>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis::lua {

namespace {

constexpr int deepest = 200;  // of the recursion, as in Lua
constexpr char escape = '%';

unsigned char byte(char c) { return static_cast<unsigned char>(c); }

bool in_class(unsigned char c, unsigned char name) {
  bool in = false;
  switch (std::tolower(name)) {
    case 'a': in = std::isalpha(c) != 0; break;
    case 'c': in = std::iscntrl(c) != 0; break;
    case 'd': in = std::isdigit(c) != 0; break;
    case 'g': in = std::isgraph(c) != 0; break;
    case 'l': in = std::islower(c) != 0; break;
    case 'p': in = std::ispunct(c) != 0; break;
    case 's': in = std::isspace(c) != 0; break;
    case 'u': in = std::isupper(c) != 0; break;
    case 'w': in = std::isalnum(c) != 0; break;
    case 'x': in = std::isxdigit(c) != 0; break;
    default: return name == c;
  }
  return std::isupper(name) != 0 ? !in : in;
}

}  // namespace

Matcher::Matcher(std::string_view text, std::string_view pattern, std::function<void(std::size_t)> work)
    : text_(text), pattern_(pattern), work_(std::move(work)) {}

std::size_t Matcher::match(std::size_t at) {
  count_ = 0;
  return step(at, 0, deepest);
}

void Matcher::report_work() {
  if (done_ > 0) work_(std::exchange(done_, 0));
}

const Matcher::Capture& Matcher::capture(std::size_t i) const {
  if (i >= count_) throw Error(fmt::format("invalid capture index %{}", i + 1));
  if (captures_[i].length == open) throw Error("unfinished capture");
  return captures_[i];
}

void Matcher::did(std::size_t steps) {
  constexpr std::size_t often = 4096;
  done_ += steps;
  if (done_ >= often) report_work();
}

std::size_t Matcher::end_of_class(std::size_t p) const {
  if (pattern_[p++] == escape) {
    if (p == pattern_.size()) throw Error("malformed pattern (ends with '%')");
    return p + 1;
  }
  if (pattern_[p - 1] != '[') return p;
  if (p < pattern_.size() && pattern_[p] == '^') ++p;
  do {  // a ']' in first position is a literal
    if (p == pattern_.size()) throw Error("malformed pattern (missing ']')");
    if (pattern_[p++] == escape) ++p;
    if (p > pattern_.size()) throw Error("malformed pattern (missing ']')");
  } while (p == pattern_.size() || pattern_[p] != ']');
  return p + 1;
}

/// Whether a byte is in the set between the brackets at `p` and `last`.
bool Matcher::in_set(unsigned char c, std::size_t p, std::size_t last) const {
  bool found = true;
  if (pattern_[p + 1] == '^') {
    found = false;
    ++p;
  }
  while (++p < last) {
    if (pattern_[p] == escape) {
      ++p;
      if (in_class(c, byte(pattern_[p]))) return found;
    } else if (pattern_[p + 1] == '-' && p + 2 < last) {
      p += 2;
      if (byte(pattern_[p - 2]) <= c && c <= byte(pattern_[p])) return found;
    } else if (byte(pattern_[p]) == c) {
      return found;
    }
  }
  return !found;
}

/// Whether the byte at a position of the text matches the pattern from `p` to `next`.
bool Matcher::single(std::size_t at, std::size_t p, std::size_t next) {
  did(pattern_[p] == '[' ? next - p : 1);
  if (at >= text_.size()) return false;
  const unsigned char c = byte(text_[at]);
  switch (pattern_[p]) {
    case '.': return true;
    case escape: return in_class(c, byte(pattern_[p + 1]));
    case '[': return in_set(c, p, next - 1);
    default: return byte(pattern_[p]) == c;
  }
}

std::size_t Matcher::step(std::size_t at, std::size_t p, int depth) {
  if (depth == 0) throw Error("pattern too complex");
  while (p < pattern_.size()) {
    did();
    switch (pattern_[p]) {
      case '(': {
        const bool place = p + 1 < pattern_.size() && pattern_[p + 1] == ')';
        return begin_capture(at, place ? p + 2 : p + 1, place, depth);
      }
      case ')': return end_capture(at, p + 1, depth);
      case '$':
        if (p + 1 == pattern_.size()) return at == text_.size() ? at : npos;
        break;
      case escape: {
        const char what = p + 1 < pattern_.size() ? pattern_[p + 1] : '\0';
        if (what == 'b') {
          at = balanced(at, p + 2);
          if (at == npos) return npos;
          p += 4;
          continue;
        }
        if (what == 'f') {
          p += 2;
          if (p == pattern_.size() || pattern_[p] != '[') throw Error("missing '[' after '%f' in pattern");
          const std::size_t next = end_of_class(p);
          const unsigned char before = at == 0 ? 0 : byte(text_[at - 1]);
          const unsigned char here = at == text_.size() ? 0 : byte(text_[at]);
          did(next - p);
          if (in_set(before, p, next - 1) || !in_set(here, p, next - 1)) return npos;
          p = next;
          continue;
        }
        if (std::isdigit(byte(what)) != 0) {
          at = repeated_capture(at, what);
          if (at == npos) return npos;
          p += 2;
          continue;
        }
        break;
      }
      default: break;
    }
    const std::size_t next = end_of_class(p);
    const char suffix = next < pattern_.size() ? pattern_[next] : '\0';
    const bool optional = suffix == '*' || suffix == '-' || suffix == '?';
    if (!single(at, p, next)) {
      if (!optional) return npos;
      p = next + 1;
      continue;
    }
    if (suffix == '*') return repeat(at, p, next, depth);
    if (suffix == '+') return repeat(at + 1, p, next, depth);
    if (suffix == '-') return repeat_least(at, p, next, depth);
    if (suffix == '?') {
      const std::size_t end = step(at + 1, next + 1, depth - 1);
      if (end != npos) return end;
      p = next + 1;
      continue;
    }
    ++at;
    p = next;
  }
  return at;
}

std::size_t Matcher::repeat(std::size_t at, std::size_t p, std::size_t next, int depth) {
  std::size_t count = 0;
  while (single(at + count, p, next)) ++count;
  for (std::size_t k = count + 1; k-- > 0;) {
    const std::size_t end = step(at + k, next + 1, depth - 1);
    if (end != npos) return end;
  }
  return npos;
}

std::size_t Matcher::repeat_least(std::size_t at, std::size_t p, std::size_t next, int depth) {
  while (true) {
    const std::size_t end = step(at, next + 1, depth - 1);
    if (end != npos) return end;
    if (!single(at, p, next)) return npos;
    ++at;
  }
}

std::size_t Matcher::begin_capture(std::size_t at, std::size_t p, bool place, int depth) {
  if (count_ >= most_captures) throw Error("too many captures");
  captures_[count_] = {at, place ? 0 : open, place};
  ++count_;
  const std::size_t end = step(at, p, depth - 1);
  if (end == npos) --count_;
  return end;
}

std::size_t Matcher::end_capture(std::size_t at, std::size_t p, int depth) {
  std::size_t i = count_;
  while (i > 0 && captures_[i - 1].length != open) --i;
  if (i == 0) throw Error("invalid pattern capture");
  Capture& closed = captures_[i - 1];
  closed.length = at - closed.begin;
  const std::size_t end = step(at, p, depth - 1);
  if (end == npos) closed.length = open;
  return end;
}

std::size_t Matcher::balanced(std::size_t at, std::size_t p) {
  if (p + 1 >= pattern_.size()) throw Error("malformed pattern (missing arguments to '%b')");
  if (at >= text_.size() || text_[at] != pattern_[p]) return npos;
  std::size_t open_ones = 1;
  for (std::size_t i = at + 1; i < text_.size(); ++i) {
    did();
    if (text_[i] == pattern_[p + 1]) {
      if (--open_ones == 0) return i + 1;
    } else if (text_[i] == pattern_[p]) {
      ++open_ones;
    }
  }
  return npos;
}

std::size_t Matcher::repeated_capture(std::size_t at, char digit) {
  const auto i = static_cast<std::size_t>(digit - '1');  // wraps for 0
  if (i >= count_ || captures_[i].length == open) throw Error(fmt::format("invalid capture index %{}", digit));
  const Capture& captured = captures_[i];
  if (captured.place) return npos;
  constexpr std::size_t bytes = 16;  // compared in one step
  did(captured.length / bytes);
  return text_.substr(at).starts_with(text_.substr(captured.begin, captured.length)) ? at + captured.length : npos;
}

}  // namespace trellis::lua
