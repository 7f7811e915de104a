// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace trellis {

/// A table without rules, with headings of one line. Its first column names the rows.
class Grid {
 public:
  struct Column {
    std::string heading;
    bool left = false;      ///< left-aligned; numbers are right-aligned
    std::size_t gap = 2;    ///< spaces before it
    std::size_t least = 0;  ///< its least width
  };

  explicit Grid(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// One cell for each column.
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// An empty line and a heading of the rows that follow.
  void section(std::string heading) { rows_.push_back({std::move(heading)}); }

  /// Returns the width of the whole in columns.
  [[nodiscard]] std::size_t width() const;
  /// Returns the table. Leaves out columns without any text. Where it is wider than `width`, the last columns follow in
  /// a second table that repeats the first column; where even that is too wide, the first column is shortened.
  [[nodiscard]] std::string text(std::size_t width) const;

 private:
  [[nodiscard]] std::vector<std::size_t> widths() const;
  [[nodiscard]] std::string part(const std::vector<std::size_t>& chosen, const std::vector<std::size_t>& widths) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace trellis
