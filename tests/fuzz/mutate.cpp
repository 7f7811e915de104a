// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

#include "fuzz.hpp"

namespace trellis::fuzz {

namespace {

std::size_t below(std::size_t limit, std::mt19937_64& random) { return limit == 0 ? 0 : random() % limit; }

bool in_number(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == 'e'; }

/// Replaces the number at or after a random position by an extreme one.
void replace_number(std::string& text, std::mt19937_64& random) {
  std::size_t begin = below(text.size(), random);
  while (begin < text.size() && std::isdigit(static_cast<unsigned char>(text[begin])) == 0) ++begin;
  std::size_t end = begin;
  while (end < text.size() && in_number(text[end])) ++end;
  if (begin < end) text.replace(begin, end - begin, extreme_number(random));
}

/// Removes, repeats or moves a line.
void change_line(std::string& text, std::mt19937_64& random) {
  const std::size_t at = below(text.size(), random);
  const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
  const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
  const std::string line = text.substr(begin, end - begin);
  if (random() % 2 == 0) text.erase(begin, end - begin);
  if (random() % 2 == 0) text.insert(below(text.size(), random), line);
}

void change_byte(std::string& text, std::mt19937_64& random) {
  char& byte = text[below(text.size(), random)];
  byte = random() % 2 == 0 ? static_cast<char>(random()) : static_cast<char>(byte ^ (1 << (random() % 8)));
}

/// Removes, repeats or truncates a stretch.
void change_stretch(std::string& text, std::mt19937_64& random) {
  const std::size_t begin = below(text.size(), random);
  const std::size_t length = 1 + below(std::min<std::size_t>(text.size() - begin, 64), random);
  switch (random() % 3) {
    case 0: text.erase(begin, length); break;
    case 1: text.insert(begin, text.substr(begin, length)); break;
    default: text.resize(begin);
  }
}

}  // namespace

std::string extreme_number(std::mt19937_64& random) {
  static constexpr std::array<const char*, 26> numbers = {"0",          "-0",
                                                          "1",          "-1",
                                                          "0.5",        "1e-3",
                                                          "1e3",        "1e6",
                                                          "1e9",        "1e12",
                                                          "1e16",       "1e18",
                                                          "1e150",      "1e308",
                                                          "1e309",      "1e-12",
                                                          "1e-300",     "1e-310",
                                                          "5e-324",     "-1e308",
                                                          "1e-16",      "nan",
                                                          "inf",        "65536",
                                                          "2147483648", "9007199254740993"};
  return any_of(numbers, random);
}

std::string mutated_text(std::string text, std::mt19937_64& random) {
  for (std::size_t changes = 1 + random() % 4; changes > 0 && !text.empty(); --changes) {
    switch (random() % 4) {
      case 0: replace_number(text, random); break;
      case 1: change_line(text, random); break;
      case 2: change_byte(text, random); break;
      default: change_stretch(text, random);
    }
  }
  return text;
}

}  // namespace trellis::fuzz

#ifdef TRELLIS_LIBFUZZER
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

/// Half of the mutations are libFuzzer's own.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  std::mt19937_64 random(seed);
  if (random() % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string text = trellis::fuzz::mutated(std::string(reinterpret_cast<const char*>(data), size), random);
  const std::size_t length = std::min(text.size(), most);
  std::memcpy(data, text.data(), length);
  return length;
}
#endif
