// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/views/grid.hpp>

#include <algorithm>

#include <trellis/report/views/table.hpp>

namespace trellis {

namespace {

/// The first column is never narrower than this.
constexpr std::size_t least_label = 12;

}  // namespace

std::vector<std::size_t> Grid::widths() const {
  std::vector<std::size_t> found;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    std::size_t widest = 0;
    for (const auto& row : rows_) widest = std::max(widest, row.size() == columns_.size() ? display_width(row[c]) : 0);
    // A column without any text has no heading either.
    if (widest > 0 || c == 0) widest = std::max({widest, columns_[c].least, display_width(columns_[c].heading)});
    found.push_back(widest);
  }
  return found;
}

std::size_t Grid::width() const {
  const std::vector<std::size_t> all = widths();
  std::size_t sum = all.front();
  for (std::size_t c = 1; c < all.size(); ++c) sum += all[c] > 0 ? columns_[c].gap + all[c] : 0;
  return sum;
}

std::string Grid::part(const std::vector<std::size_t>& chosen, const std::vector<std::size_t>& widths) const {
  std::string out;
  const auto add = [&](const auto& cell) {
    std::string line;
    for (const std::size_t c : chosen) {
      if (c > 0) line += std::string(columns_[c].gap, ' ');
      line += pad(shortened(cell(c), widths[c]), widths[c], c > 0 && !columns_[c].left);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + '\n';
  };
  add([&](std::size_t c) { return columns_[c].heading; });
  for (const auto& row : rows_) {
    if (row.size() == columns_.size()) {
      add([&](std::size_t c) { return row[c]; });
    } else {
      out += '\n' + row.front() + '\n';
    }
  }
  return out;
}

std::string Grid::text(std::size_t width) const {
  std::vector<std::size_t> all = widths();
  // The first column is shortened until the widest other one has a place.
  std::size_t needed = 0;
  for (std::size_t c = 1; c < all.size(); ++c) needed = std::max(needed, all[c] > 0 ? columns_[c].gap + all[c] : 0);
  if (all.front() + needed > width) {
    all.front() = std::min(all.front(), std::max(least_label, width > needed ? width - needed : 0));
  }
  std::string out;
  std::vector<std::size_t> chosen = {0};
  std::size_t used = all.front();
  for (std::size_t c = 1; c < all.size(); ++c) {
    if (all[c] == 0) continue;
    if (chosen.size() > 1 && used + columns_[c].gap + all[c] > width) {
      out += part(chosen, all) + '\n';
      chosen = {0};
      used = all.front();
    }
    chosen.push_back(c);
    used += columns_[c].gap + all[c];
  }
  return out + part(chosen, all);
}

}  // namespace trellis
