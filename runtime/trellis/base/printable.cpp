// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/printable.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace trellis {

namespace {

constexpr unsigned char first_of_several = 0x80;

bool is_plain(char c) {
  const auto byte = static_cast<unsigned char>(c);
  constexpr unsigned char space = 0x20, erase = 0x7f;
  return (byte >= space && byte < erase) || c == '\n' || c == '\t';
}

struct Character {
  char32_t code = 0;
  std::size_t size = 0;  ///< bytes; 0 where the text is not UTF-8
};

/// Reads the character of several bytes at the beginning of a text.
Character several_bytes(std::string_view text) {
  constexpr unsigned char two = 0xC0, three = 0xE0, four = 0xF0, none = 0xF8;
  constexpr unsigned bits = 6;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char head = byte(0);
  if (head < two || head >= none) return {};
  const std::size_t size = head < three ? 2 : head < four ? 3 : 4;
  if (text.size() < size) return {};
  char32_t code = head & (0xFFU >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & two) != first_of_several) return {};
    code = code << bits | (byte(i) & 0x3FU);
  }
  constexpr char32_t least[] = {0, 0, 0x80, 0x800, 0x10000};  // NOLINT: by the number of bytes
  constexpr char32_t most = 0x10FFFF, surrogates = 0xD800, after_surrogates = 0xE000;
  if (code < least[size] || code > most || (code >= surrogates && code < after_surrogates)) return {};
  return {code, size};
}

/// Whether a terminal may obey the character instead of showing it.
bool is_obeyed(char32_t code) {
  return (code >= 0x80 && code < 0xA0) || code == 0x061C || code == 0x200E || code == 0x200F ||
         (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::string printable(std::string_view text) {
  if (std::all_of(text.begin(), text.end(), is_plain)) return std::string(text);
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    std::size_t size = 1;
    const auto byte = static_cast<unsigned char>(text.front());
    if (is_plain(text.front())) {
      shown += text.front();
    } else if (const Character c = byte >= first_of_several ? several_bytes(text) : Character{}; c.size == 0) {
      fmt::format_to(std::back_inserter(shown), "\\x{:02x}", byte);
    } else {
      size = c.size;
      if (is_obeyed(c.code)) {
        fmt::format_to(std::back_inserter(shown), "\\u{{{:04x}}}", static_cast<unsigned>(c.code));
      } else {
        shown += text.substr(0, size);
      }
    }
    text.remove_prefix(size);
  }
  return shown;
}

}  // namespace trellis
