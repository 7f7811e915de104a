// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/views/table.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

std::string repeat(std::string_view what, std::size_t times) {
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += what;
  return out;
}

void append_line(std::string& out, std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  out += line;
  out += '\n';
}

struct Range {
  std::uint32_t first;
  std::uint32_t last;
};
/// Characters of two columns: East Asian wide ones and emoji (Unicode's EastAsianWidth, W and F, in blocks).
constexpr std::array<Range, 13> wide = {{{0x1100, 0x115F},
                                         {0x2E80, 0x303E},
                                         {0x3041, 0x4DBF},
                                         {0x4E00, 0xA4CF},
                                         {0xA960, 0xA97C},
                                         {0xAC00, 0xD7A3},
                                         {0xF900, 0xFAFF},
                                         {0xFE30, 0xFE6F},
                                         {0xFF00, 0xFF60},
                                         {0xFFE0, 0xFFE6},
                                         {0x1F300, 0x1F64F},
                                         {0x1F680, 0x1F9FF},
                                         {0x20000, 0x3FFFD}}};
/// Characters of no column: they combine with the one before.
constexpr std::array<Range, 6> combining = {
    {{0x0300, 0x036F}, {0x1AB0, 0x1AFF}, {0x200B, 0x200F}, {0x20D0, 0x20FF}, {0xFE00, 0xFE0F}, {0xFE20, 0xFE2F}}};

std::size_t columns_of(std::uint32_t point) {
  const auto in = [&](const auto& ranges) {
    return std::any_of(ranges.begin(), ranges.end(),
                       [&](const Range& r) { return r.first <= point && point <= r.last; });
  };
  return in(combining) ? 0 : in(wide) ? 2 : 1;
}

/// Adjacent columns with a common heading; a column without one is a span of its own.
struct Span {
  std::size_t first = 0;  ///< positions in the list of chosen columns
  std::size_t last = 0;
};

}  // namespace

std::size_t display_width(std::string_view text) {
  std::size_t width = 0;
  std::uint32_t point = 0;
  const auto count = [&] { width += point == 0 ? 0 : columns_of(point); };
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0U) == 0x80U) {
      point = (point << 6U) | (byte & 0x3FU);
      continue;
    }
    count();
    point = byte < 0x80U ? byte : byte < 0xE0U ? byte & 0x1FU : byte < 0xF0U ? byte & 0x0FU : byte & 0x07U;
  }
  count();
  return width;
}

std::string shortened(const std::string& text, std::size_t columns) {
  if (display_width(text) <= columns) return text;
  std::string cut = text;
  // Removes whole code points: a continuation byte never ends a text.
  while (display_width(cut) >= columns) {
    while ((static_cast<unsigned char>(cut.back()) & 0xC0U) == 0x80U) cut.pop_back();
    cut.pop_back();
  }
  return cut + "…";
}

std::string pad(const std::string& text, std::size_t width, bool left_pad) {
  const std::size_t shown = display_width(text);
  const std::string fill(width > shown ? width - shown : 0, ' ');
  return left_pad ? fill + text : text + fill;
}

std::string wrap(const std::string& text, std::size_t width, const std::string& first, const std::string& indent) {
  std::string out;
  std::string line = first;
  bool begun = false;  // the line has a word
  std::size_t from = 0;
  while (from < text.size()) {
    const std::size_t to = std::min(text.find(' ', from), text.size());
    const std::string word = text.substr(from, to - from);
    from = to + 1;
    if (begun && display_width(line) + 1 + display_width(word) > width) {
      append_line(out, std::exchange(line, indent));
      begun = false;
    }
    line += (begun ? " " : "") + word;
    begun = true;
  }
  append_line(out, line);
  std::replace(out.begin(), out.end(), no_break, ' ');
  return out;
}

void Table::add(std::vector<std::string> cells) {
  if (cells.size() != columns_.size()) throw Fault("a table's row has another number of cells than columns");
  rows_.push_back(std::move(cells));
}

/// The layout of a part of a table: its columns, their widths, and the spans of columns with the same group.
struct Table::Layout {
  const std::vector<std::size_t>& columns;
  std::size_t gap;
  std::vector<std::size_t> widths = {};
  std::vector<Span> spans = {};
  std::size_t heading_lines = 0;

  [[nodiscard]] std::size_t width(const Span& span) const {
    std::size_t all = (span.last - span.first) * gap;
    for (std::size_t i = span.first; i <= span.last; ++i) all += widths[i];
    return all;
  }
  /// Joins a line's cells; `cell(i)` is the text of column i of the part.
  template <class Cell>
  [[nodiscard]] std::string line(const std::vector<Column>& all, const Cell& cell) const {
    std::string text;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) text += std::string(gap, ' ');
      text += pad(cell(i), widths[i], !all[columns[i]].left);
    }
    return text;
  }
};

Table::Layout Table::layout_of(const std::vector<std::size_t>& columns, std::size_t gap) const {
  Layout layout{columns, gap};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Column& column = columns_[columns[i]];
    std::size_t width = 0;
    for (const auto& line : column.heading) width = std::max(width, display_width(line));
    for (const auto& row : rows_) width = std::max(width, display_width(row[columns[i]]));
    layout.widths.push_back(width);
    layout.heading_lines = std::max(layout.heading_lines, column.heading.size());
    if (i > 0 && !column.group.empty() && columns_[columns[i - 1]].group == column.group) {
      layout.spans.back().last = i;
    } else {
      layout.spans.push_back({i, i});
    }
  }
  for (const Span& span : layout.spans) {
    const std::size_t needed = display_width(columns_[columns[span.first]].group);
    const std::size_t width = layout.width(span);
    if (needed > width) layout.widths[span.last] += needed - width;
  }
  return layout;
}

std::string Table::headings(const Layout& layout) const {
  const auto group = [&](const Span& span) -> const std::string& { return columns_[layout.columns[span.first]].group; };
  std::string out;
  if (std::any_of(layout.spans.begin(), layout.spans.end(), [&](const Span& span) { return !group(span).empty(); })) {
    std::string line;
    for (const auto& span : layout.spans) {
      if (span.first > 0) line += std::string(layout.gap, ' ');
      std::string label = group(span);
      const std::size_t width = layout.width(span);
      const std::size_t used = display_width(label);
      if (!label.empty() && used + 1 < width) label += ' ' + repeat("─", width - used - 1);
      line += pad(label, width, false);
    }
    append_line(out, std::move(line));
  }
  for (std::size_t h = 0; h < layout.heading_lines; ++h) {
    append_line(out, layout.line(columns_, [&](std::size_t i) -> std::string {
      const auto& heading = columns_[layout.columns[i]].heading;
      const std::size_t above = layout.heading_lines - heading.size();  // headings are bottom-aligned
      return h < above ? "" : heading[h - above];
    }));
  }
  return out;
}

std::string Table::part(const std::vector<std::size_t>& columns, std::size_t gap) const {
  const Layout layout = layout_of(columns, gap);
  const auto& widths = layout.widths;
  const std::size_t total = std::accumulate(widths.begin(), widths.end(), gap * (widths.size() - 1));
  const std::string thin = repeat("─", total) + '\n';
  std::string out = headings(layout) + thin;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    // Omit a row without values from this part of a split table.
    const bool blank =
        columns.size() > keys() && std::all_of(columns.begin() + static_cast<std::ptrdiff_t>(keys()), columns.end(),
                                               [&](std::size_t c) { return rows_[r][c].empty(); });
    if (blank) continue;
    if (std::find(rules_.begin(), rules_.end(), r) != rules_.end()) out += thin;
    append_line(out, layout.line(columns_, [&](std::size_t i) { return rows_[r][columns[i]]; }));
  }
  return out;
}

std::size_t Table::keys() const {
  std::size_t count = 1;
  while (count < columns_.size() && columns_[count].key) ++count;
  return count;
}

std::string Table::text(std::size_t width) const {
  const auto fits = [&](const std::string& table) {
    for (std::size_t from = 0; from < table.size();) {
      const std::size_t to = table.find('\n', from);
      if (display_width(std::string_view(table).substr(from, to - from)) > width) return false;
      from = to + 1;
    }
    return true;
  };
  std::vector<std::size_t> all(columns_.size());
  std::iota(all.begin(), all.end(), 0U);
  for (const std::size_t gap : {2U, 1U}) {
    std::string whole = part(all, gap);
    if (fits(whole)) return whole;
  }

  std::string out;
  const std::vector<std::size_t> named(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(keys()));
  std::vector<std::size_t> chosen = named;
  std::size_t c = named.size();
  while (c < columns_.size()) {
    // The next block: a group, or a column without a group.
    std::size_t end = c + 1;
    while (end < columns_.size() && !columns_[c].group.empty() && columns_[end].group == columns_[c].group) ++end;
    const auto with = [&](std::size_t to) {
      std::vector<std::size_t> more = chosen;
      for (std::size_t i = c; i < to; ++i) more.push_back(i);
      return more;
    };
    if (!fits(part(with(end), 2))) {
      if (chosen.size() > named.size()) {
        out += part(chosen, 2) + '\n';
        chosen = named;
        continue;
      }
      // The group alone is too wide: take as many of its columns as fit, at least one.
      while (end > c + 1 && !fits(part(with(end), 2))) --end;
    }
    chosen = with(end);
    c = end;
  }
  return out + part(chosen, 2);
}

}  // namespace trellis
