// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <sstream>
#include <system_error>
#include <utility>

#include <trellis/base/input_file.hpp>
#include <trellis/reader/formats.hpp>

namespace trellis {

namespace {

void require_no_fault(const std::string& path, const std::string& fault) {
  if (fault.empty()) return;
  std::error_code ignored;
  const char* what = std::filesystem::exists(path, ignored) ? "read" : "opened";
  throw Error(fmt::format("{}: the file cannot be {}: {}", path, what, fault));
}

}  // namespace

void require_readable(const std::string& path) { require_no_fault(path, input_fault(path, most_file_bytes)); }

SourceText SourceText::load(const std::string& path) {
  InputFile file(path, most_file_bytes);
  const std::string all = file.rest();
  require_no_fault(path, file.fault());
  SourceText text{path, {}};
  for (std::size_t begin = 0; begin < all.size();) {
    const std::size_t end = std::min(all.find('\n', begin), all.size());
    std::string line = all.substr(begin, end - begin);
    begin = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (text.lines.empty() && line.starts_with(byte_order_mark)) line.erase(0, byte_order_mark.size());
    if (text.lines.size() == most_file_lines) {
      throw text.error(most_file_lines, fmt::format("more than {} lines", most_file_lines));
    }
    text.lines.push_back(std::move(line));
  }
  return text;
}

Error SourceText::error(std::size_t line, const std::string& fault) const {
  return Error(fmt::format("{}:{}: {}", path, line, fault));
}

std::string SourceText::joined() const {
  std::string all;
  for (const auto& line : lines) all += line + '\n';
  return all;
}

bool has_key(const SourceText& text, std::string_view key) {
  const auto keyed = [&](std::string_view line) {
    line = line.substr(0, line.find('#') == 0 ? 0 : line.find(" #"));
    for (std::size_t at = line.find(key); at != std::string_view::npos; at = line.find(key, at + 1)) {
      if (at > 0 && std::string_view(" \t{,\"'").find(line[at - 1]) == std::string_view::npos) continue;
      std::string_view rest = line.substr(at + key.size());
      if (!rest.empty() && (rest.front() == '"' || rest.front() == '\'')) rest.remove_prefix(1);
      const std::size_t colon = rest.find_first_not_of(" \t");
      if (colon != std::string_view::npos && rest[colon] == ':') return true;
    }
    return false;
  };
  return std::any_of(text.lines.begin(), text.lines.end(), keyed);
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  return {std::istream_iterator<std::string>(in), {}};
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::size_t begin = 0;
  for (std::size_t comma = line.find(','); comma != std::string::npos; comma = line.find(',', begin)) {
    cells.push_back(line.substr(begin, comma - begin));
    begin = comma + 1;
  }
  cells.push_back(line.substr(begin));
  return cells;
}

std::string first_bytes(const std::string& path) {
  constexpr std::size_t enough = 64;
  InputFile file(path, std::numeric_limits<std::uintmax_t>::max());
  std::string block;
  if (!file.fault().empty() || !file.next(block)) return "";
  return block.substr(0, enough);
}

double number_in(const SourceText& text, std::size_t line, const std::string& word, const char* what) {
  double value = 0.0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    throw text.error(line, fmt::format("{} is '{}', expected a finite number", what, word));
  }
  return value;
}

std::size_t count_in(const SourceText& text, std::size_t line, const std::string& word, const char* what) {
  constexpr long most = 1'000'000'000;
  long value = 0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || end != word.data() + word.size() || value < 0 || value > most) {
    throw text.error(line, fmt::format("{} is '{}', expected a whole number of at least 0", what, word));
  }
  return static_cast<std::size_t>(value);
}

std::string stem_of(const std::string& path) { return std::filesystem::path(path).stem().string(); }

}  // namespace trellis
