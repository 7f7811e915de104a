// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/table.hpp>

#include <algorithm>
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

/// Adjacent columns with a common heading; a column without one is a span of its own.
struct Span {
  std::size_t first = 0;  ///< positions in the list of chosen columns
  std::size_t last = 0;
};

}  // namespace

std::size_t display_width(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
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

std::string Table::part(const std::vector<std::size_t>& columns, std::size_t gap) const {
  std::vector<std::size_t> widths;
  std::size_t heading_lines = 0;
  for (const auto c : columns) {
    std::size_t width = 0;
    for (const auto& line : columns_[c].heading) width = std::max(width, display_width(line));
    for (const auto& row : rows_) width = std::max(width, display_width(row[c]));
    widths.push_back(width);
    heading_lines = std::max(heading_lines, columns_[c].heading.size());
  }

  std::vector<Span> spans;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string& group = columns_[columns[i]].group;
    if (i > 0 && !group.empty() && columns_[columns[i - 1]].group == group) {
      spans.back().last = i;
    } else {
      spans.push_back({i, i});
    }
  }
  const auto span_width = [&](const Span& span) {
    std::size_t width = (span.last - span.first) * gap;
    for (std::size_t i = span.first; i <= span.last; ++i) width += widths[i];
    return width;
  };
  bool grouped = false;
  for (const auto& span : spans) {
    const std::string& group = columns_[columns[span.first]].group;
    grouped = grouped || !group.empty();
    const std::size_t needed = display_width(group);
    if (needed > span_width(span)) widths[span.last] += needed - span_width(span);
  }

  const std::string space(gap, ' ');
  std::string out;
  if (grouped) {
    std::string line;
    for (const auto& span : spans) {
      const std::string& group = columns_[columns[span.first]].group;
      if (span.first > 0) line += space;
      std::string label = group;
      const std::size_t width = span_width(span);
      if (!group.empty() && display_width(group) + 1 < width) {
        label += ' ' + repeat("─", width - display_width(group) - 1);
      }
      line += pad(label, width, false);
    }
    append_line(out, std::move(line));
  }
  for (std::size_t h = 0; h < heading_lines; ++h) {
    std::string line;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const Column& column = columns_[columns[i]];
      const std::size_t above = heading_lines - column.heading.size();  // headings are bottom-aligned
      if (i > 0) line += space;
      line += pad(h < above ? "" : column.heading[h - above], widths[i], !column.left);
    }
    append_line(out, std::move(line));
  }
  const std::size_t total = std::accumulate(widths.begin(), widths.end(), gap * (widths.size() - 1));
  const std::string thin = repeat("─", total) + '\n';
  out += thin;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    // Omit a row without values from this part of a split table.
    const bool blank = columns.size() > 1 && std::all_of(columns.begin() + 1, columns.end(),
                                                         [&](std::size_t c) { return rows_[r][c].empty(); });
    if (blank) continue;
    if (std::find(rules_.begin(), rules_.end(), r) != rules_.end()) out += thin;
    std::string line;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) line += space;
      line += pad(rows_[r][columns[i]], widths[i], !columns_[columns[i]].left);
    }
    append_line(out, std::move(line));
  }
  return out;
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
  std::vector<std::size_t> chosen = {0};
  std::size_t c = 1;
  while (c < columns_.size()) {
    // The next block: a group, or a column without a group.
    std::size_t end = c + 1;
    while (end < columns_.size() && !columns_[c].group.empty() && columns_[end].group == columns_[c].group) ++end;
    const auto with = [&](std::size_t to) {
      std::vector<std::size_t> more = chosen;
      for (std::size_t i = c; i < to; ++i) more.push_back(i);
      return more;
    };
    const bool groups_begin = columns_[c - 1].group.empty() && !columns_[c].group.empty();
    if (!fits(part(with(end), 2)) || (groups_begin && chosen.size() > 1)) {
      if (chosen.size() > 1) {
        out += part(chosen, 2) + '\n';
        chosen = {0};
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
