// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/unused.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

namespace trellis {

std::string more_lines(std::vector<std::size_t> lines) {
  constexpr std::size_t most = 5;
  if (lines.size() < 2) return "";
  std::sort(lines.begin(), lines.end());
  const std::size_t more = lines.size() - 1;
  lines.erase(lines.begin());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  const bool cut = lines.size() > most;
  if (cut) lines.resize(most);
  return fmt::format(" ({} more: line{} {}{})", more, lines.size() == 1 ? "" : "s", fmt::join(lines, ", "),
                     cut ? ", ..." : "");
}

std::vector<std::string> unused_warnings(const SourceText& text, std::vector<Unused> entries) {
  std::stable_sort(entries.begin(), entries.end(), [](const Unused& a, const Unused& b) { return a.line < b.line; });
  std::map<std::string, std::vector<std::size_t>> lines;
  std::vector<std::string> names;  // in the order of their first lines
  for (Unused& entry : entries) {
    std::vector<std::size_t>& at = lines[entry.name];
    at.push_back(entry.line);
    if (at.size() == 1) names.push_back(std::move(entry.name));
  }
  std::vector<std::string> warnings;
  warnings.reserve(names.size());
  for (const std::string& name : names) {
    const std::vector<std::size_t>& at = lines[name];
    warnings.push_back(fmt::format("{}:{}: '{}' is not read{}", text.path, at.front(), name, more_lines(at)));
  }
  return warnings;
}

}  // namespace trellis
