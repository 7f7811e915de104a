// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace trellis {

/// Columns that a terminal shows the string in: code points, which is right for all that a report prints.
std::size_t display_width(std::string_view text);

/// Fills with spaces on the right or, `left_pad`, on the left.
std::string pad(const std::string& text, std::size_t width, bool left_pad);

/// A space at which wrap() does not break; it comes out as a plain one.
inline constexpr char no_break = '\x1f';

/// Breaks text at spaces into lines of at most `width` columns. `first` stands before the first line, `indent` before
/// the others. A word longer than a line stays whole. Ends with a newline.
std::string wrap(const std::string& text, std::size_t width, const std::string& first = "",
                 const std::string& indent = "");

/// A table in plain columns: headings of several lines, groups of columns under a common heading, thin rules.
class Table {
 public:
  struct Column {
    std::vector<std::string> heading;  ///< lines, the last one lowest
    std::string group;                 ///< neighbours of the same group share a heading above theirs
    bool left = false;                 ///< flush left; numbers are flush right
  };

  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// One cell for each column.
  void add(std::vector<std::string> cells);
  /// A thin rule before the next row.
  void rule() { rules_.push_back(rows_.size()); }
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }

  /// The table in at most `width` columns: where it is wider, columns are put closer together, and if that is not
  /// enough, those that do not fit follow in a second table under the first column repeated; groups stay together
  /// where they can.
  [[nodiscard]] std::string text(std::size_t width) const;

 private:
  [[nodiscard]] std::string part(const std::vector<std::size_t>& columns, std::size_t gap) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> rules_;
};

}  // namespace trellis
