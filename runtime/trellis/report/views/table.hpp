// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace trellis {

/// Returns the width in terminal columns: two for wide characters (Chinese, Japanese, Korean, emoji), none for
/// combining ones.
std::size_t display_width(std::string_view text);

/// Pads with spaces on the right or, with `left_pad`, on the left.
std::string pad(const std::string& text, std::size_t width, bool left_pad);

/// Shortens a text to a number of columns; an ellipsis replaces the rest.
std::string shortened(const std::string& text, std::size_t columns);

/// A space at which wrap() does not break; prints as a normal space.
inline constexpr char no_break = '\x1f';

/// Breaks text at spaces into lines of at most `width` columns, with the prefix `first` on the first line and `indent`
/// on the others. Does not break a longer word. Ends with a newline.
std::string wrap(const std::string& text, std::size_t width, const std::string& first = "",
                 const std::string& indent = "");

/// A table in plain columns: headings of several lines, groups of columns under a common heading, thin rules.
class Table {
 public:
  struct Column {
    std::vector<std::string> heading;  ///< lines, the last one lowest
    std::string group;                 ///< adjacent columns of one group share a heading above their own
    bool left = false;                 ///< left-aligned; numbers are right-aligned
    bool key = false;                  ///< names the row together with the columns before, which are keys too
  };

  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// One cell for each column.
  void add(std::vector<std::string> cells);
  /// A thin rule before the next row.
  void rule() { rules_.push_back(rows_.size()); }
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }

  /// Returns the table in at most `width` columns. A wider table gets narrower gaps; if that is not enough, the
  /// remaining columns follow in a second table that repeats the first column and the keys after it. Groups stay
  /// together where possible.
  [[nodiscard]] std::string text(std::size_t width) const;

 private:
  struct Layout;
  [[nodiscard]] Layout layout_of(const std::vector<std::size_t>& columns, std::size_t gap) const;
  [[nodiscard]] std::string headings(const Layout& layout) const;
  /// Returns the number of columns that name a row: the first one and the keys after it.
  [[nodiscard]] std::size_t keys() const;
  [[nodiscard]] std::string part(const std::vector<std::size_t>& columns, std::size_t gap) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> rules_;
};

}  // namespace trellis
