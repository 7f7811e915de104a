// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/store/csv.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <system_error>

#include <dsl/language/core/stdlib.hpp>
#include <trellis/base/error.hpp>
#include <trellis/base/errors.hpp>

namespace trellis::command {

namespace {

constexpr std::size_t most_faults = 1000;  // rows with one; then the file is something else
constexpr std::size_t largest_csv = std::size_t{4} << 30U;

bool is_padding(char c) { return c == ' ' || c == '\t'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_padding(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_padding(text.back())) text.remove_suffix(1);
  return text;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string shown(text.substr(0, longest));
  // Control characters would cut the message or disturb the terminal.
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return fmt::format("'{}{}'", shown, text.size() > longest ? "..." : "");
}

/// Iterates over the lines of a text.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  /// Reads the next line without its end; returns false after the last one.
  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++number_;
    return true;
  }
  [[nodiscard]] std::size_t number() const { return number_; }
  /// Whether only blank lines follow.
  [[nodiscard]] bool done() const { return rest_.find_first_not_of(" \t\r\n") == std::string_view::npos; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

class Reader {
 public:
  Reader(const std::string& path, const std::vector<std::string>& columns)
      : path_(path), columns_(columns), header_(fmt::format("{}", fmt::join(columns, ","))) {}

  Configurations read(std::string_view text) {
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
      throw Error(fmt::format("{}: the file is in UTF-16; save it as UTF-8", path_));
    }
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    Lines lines(text);
    if (lines.done()) {
      throw Error(
          fmt::format("{}: the file is empty; expected the header '{}' and a line for each sample", path_, header_));
    }
    std::string_view line;
    lines.next(line);
    read_header(line);
    if (lines.done()) throw Error(fmt::format("{}: there is no sample below the header", path_));
    Configurations rows(columns_.size());
    rows.reserve(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')));
    Configuration row(columns_.size());
    ErrorList errors;
    while (!lines.done() && lines.next(line)) {
      try {
        read_row(line, lines.number(), row);
        rows.push(row);
      } catch (const Error& error) {
        errors.add(error);
        if (++faults_ == most_faults) break;
      }
    }
    errors.raise();
    return rows;
  }

 private:
  [[noreturn]] void fail(std::size_t line, std::size_t column, const std::string& what) const {
    throw Error(fmt::format("{}:{}:{}: {}", path_, line, column + 1, what));
  }

  void read_header(std::string_view line) {
    std::size_t begin = 0;
    while (begin <= line.size()) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      std::string_view name = trimmed(line.substr(begin, end - begin));
      if (name.size() > 1 && name.starts_with('"') && name.ends_with('"')) name = name.substr(1, name.size() - 2);
      const auto at = std::find(columns_.begin(), columns_.end(), name);
      if (at == columns_.end()) fail(1, begin, not_a_column(name));
      const auto place = static_cast<std::size_t>(at - columns_.begin());
      if (std::find(order_.begin(), order_.end(), place) != order_.end()) {
        fail(1, begin, fmt::format("the column {} is there twice", quoted(name)));
      }
      order_.push_back(place);
      begin = end + 1;
    }
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      if (std::find(order_.begin(), order_.end(), j) != order_.end()) continue;
      fail(1, line.size(), fmt::format("the column '{}' is missing; expected the header '{}'", columns_[j], header_));
    }
  }

  [[nodiscard]] std::string not_a_column(std::string_view name) const {
    double number = 0.0;
    const auto read = std::from_chars(name.data(), name.data() + name.size(), number);
    if (!name.empty() && read.ptr == name.data() + name.size()) {
      return fmt::format("expected the header '{}', got the number {}", header_, name);
    }
    const std::string other = name.find(';') != std::string_view::npos    ? "; columns are separated by ',', not ';'"
                              : name.find('\t') != std::string_view::npos ? "; columns are separated by ',', not tabs"
                                                                          : "";
    return fmt::format("no coordinate is called {}{}; expected the header '{}'{}", quoted(name),
                       did_you_mean(name, columns_), header_, other);
  }

  void read_row(std::string_view line, std::size_t number, Configuration& row) const {
    const char* const begin = line.data();
    const char* const end = begin + line.size();
    const char* at = begin;
    const auto column = [&](const char* place) { return static_cast<std::size_t>(place - begin); };
    for (std::size_t cell = 0; cell < order_.size(); ++cell) {
      while (at != end && is_padding(*at)) ++at;
      double& value = row[order_[cell]];
      // from_chars does not accept this sign.
      const bool plus = end - at > 1 && at[0] == '+' && at[1] != '-';
      const auto [stop, error] = std::from_chars(at + (plus ? 1 : 0), end, value);
      const char* rest = stop;
      while (rest != end && is_padding(*rest)) ++rest;
      const bool whole = error != std::errc::invalid_argument && (rest == end || *rest == ',');
      if (!whole || error != std::errc() || !std::isfinite(value)) {
        reject(line, number, column(at), cell, error == std::errc::result_out_of_range);
      }
      if (rest == end && cell + 1 < order_.size()) {
        fail(number, line.size(),
             fmt::format("too few columns: {}, expected {} ({})", cell + 1, order_.size(), header_));
      }
      if (rest != end && cell + 1 == order_.size()) {
        const auto there = static_cast<std::size_t>(std::count(begin, end, ',')) + 1;
        fail(number, column(rest),
             fmt::format("too many columns: {}, expected {} ({})", there, order_.size(), header_));
      }
      at = rest == end ? end : rest + 1;
    }
  }

  [[noreturn]] void reject(std::string_view line, std::size_t number, std::size_t column, std::size_t cell,
                           bool out_of_range) const {
    if (trimmed(line).empty()) fail(number, 0, "an empty line between samples");
    const std::string_view text = trimmed(line.substr(column, line.find(',', column) - column));
    const std::string got = text.empty() ? "an empty cell" : quoted(text);
    fail(number, column,
         fmt::format("{} must be a finite number{}, got {}", columns_[order_[cell]],
                     out_of_range ? " that a double can hold" : "", got));
  }

  const std::string& path_;
  const std::vector<std::string>& columns_;
  std::string header_;
  std::size_t faults_ = 0;
  std::vector<std::size_t> order_;  // index in `columns_` of each of the file's columns
};

}  // namespace

Configurations read_csv(const std::string& path, const std::vector<std::string>& columns, const std::string& named_by) {
  std::string text;
  try {
    text = dsl::read_file(path, largest_csv);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", named_by, error.what()));
  }
  return Reader(path, columns).read(text);
}

}  // namespace trellis::command
