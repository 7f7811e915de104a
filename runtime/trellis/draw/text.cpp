// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/text.hpp>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

namespace trellis::draw {

namespace {

constexpr std::string_view ellipsis = "…";
constexpr std::string_view replacement = "\uFFFD";

/// Returns the number of bytes of the first character, 0 where it is invalid.
std::size_t character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(text[i])); };
  const unsigned first = byte(0);
  if (first < 0x80U) return 1;
  const std::size_t length = first >= 0xF0U ? 4 : first >= 0xE0U ? 3 : 2;
  if (first < 0xC2U || first > 0xF4U || text.size() < length) return 0;
  unsigned code = first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
    code = (code << 6U) | (byte(i) & 0x3FU);
  }
  constexpr std::array<unsigned, 5> least = {0, 0, 0x80U, 0x800U, 0x10000U};
  const bool surrogate = code >= 0xD800U && code <= 0xDFFFU;
  return code < least[length] || code > 0x10FFFFU || surrogate ? 0 : length;
}

/// Returns the offsets of the ends of the characters of valid UTF-8, the first entry being 0.
std::vector<std::size_t> ends(std::string_view text) {
  std::vector<std::size_t> found = {0};
  for (std::size_t i = 1; i <= text.size(); ++i) {
    if (i == text.size() || (static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U) found.push_back(i);
  }
  return found;
}

/// Returns the longest prefix that fits with `tail` after it.
std::string_view prefix(std::string_view text, double width, const Font& font, std::string_view tail) {
  const auto at = ends(text);
  std::size_t fits = 0;
  std::size_t over = at.size();
  while (over - fits > 1) {
    const std::size_t middle = fits + (over - fits) / 2;
    const std::string tried = std::string(text.substr(0, at[middle])) + std::string(tail);
    (text_extents(tried, font).width <= width ? fits : over) = middle;
  }
  return text.substr(0, at[fits]);
}

std::string trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(' ');
  if (from == std::string_view::npos) return {};
  return std::string(text.substr(from, text.find_last_not_of(' ') + 1 - from));
}

}  // namespace

std::string clean_text(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = character(text);
    const auto first = static_cast<unsigned char>(text[0]);
    const bool control = (length == 1 && (first < 0x20 || first == 0x7F)) ||
                         (length == 2 && first == 0xC2 && static_cast<unsigned char>(text[1]) < 0xA0);
    if (length == 0) {
      out += replacement;
    } else {
      out += control ? " " : text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

std::string shorten(std::string_view text, double width, const Font& font) {
  std::string clean = clean_text(text);
  if (text_extents(clean, font).width <= width) return clean;
  return trimmed(prefix(clean, width, font, ellipsis)) + std::string(ellipsis);
}

std::vector<std::string> wrap_text(std::string_view text, double width, const Font& font, std::size_t most) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    const std::string paragraph = trimmed(clean_text(text.substr(from, to - from)));
    from = to + 1;
    std::string_view rest = paragraph;
    do {
      if (lines.size() + 1 >= most) {
        lines.push_back(shorten(std::string(rest) + std::string(from <= text.size() ? ellipsis : ""), width, font));
        return lines;
      }
      std::string_view line = prefix(rest, width, font, "");
      if (line.size() < rest.size() && rest[line.size()] != ' ') {
        if (const std::size_t space = line.rfind(' '); space != std::string_view::npos) line = line.substr(0, space);
      }
      if (line.empty() && !rest.empty()) line = rest.substr(0, ends(rest)[1]);
      lines.push_back(trimmed(line));
      rest.remove_prefix(line.size());
      rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
    } while (!rest.empty());
  }
  return lines;
}

std::string number_text(double value, int decimals) {
  if (std::isnan(value)) return "n/a";
  if (std::isinf(value)) return value > 0.0 ? "∞" : "−∞";
  std::string digits = fmt::format("{:.{}f}", std::abs(value), decimals);
  const bool zero = digits.find_first_not_of("0.") == std::string::npos;
  return value < 0.0 && !zero ? "−" + digits : digits;
}

std::string signed_text(double value, int decimals) {
  std::string text = number_text(value, decimals);
  const bool zero = text.find_first_not_of("0.") == std::string::npos;
  return value > 0.0 && !zero ? "+" + text : text;
}

std::string power_text(int exponent) {
  constexpr std::array<std::string_view, 10> digits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out = "10";
  for (const char c : std::to_string(exponent)) {
    out += c == '-' ? std::string_view("⁻") : digits.at(static_cast<std::size_t>(c - '0'));
  }
  return out;
}

}  // namespace trellis::draw
