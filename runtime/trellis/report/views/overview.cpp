// SPDX-License-Identifier: GPL-3.0-or-later
// The report that a run prints: lays out what ExperimentSummary::answer has.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <trellis/report/views/grid.hpp>
#include <trellis/report/views/overview.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/report/views/tables.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

/// Returns a bar of eighths of a column, `share` of `width` columns long; never empty for a positive share.
std::string bar(double share, std::size_t width) {
  static constexpr std::array<const char*, 8> eighths = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  if (!(share > 0.0)) return "";
  const auto parts = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::lround(8.0 * std::min(share, 1.0) * static_cast<double>(width))));
  std::string text;
  for (std::size_t i = 0; i < parts / 8; ++i) text += "█";
  return text + eighths[parts % 8];
}

/// The bar of a median; dots where most runs found no path.
std::string bar_of(const AnswerRow& row, double most, std::size_t width) {
  if (std::isfinite(row.checks.lo)) return bar(row.checks.lo / most, width);
  std::string dots;
  for (std::size_t i = 0; i < width && std::isinf(row.checks.lo); ++i) dots += "·";
  return dots;
}

/// \param bar_width  0: without bars
/// \param label      columns of the longest label
Grid grid_of(const AnswerTable& table, std::size_t bar_width, std::size_t label) {
  Grid grid({{.heading = "", .left = true},
             {.heading = "solved", .gap = 1, .least = 7},
             {.heading = "checks", .gap = 1, .least = 9},
             {.heading = "", .left = true, .least = bar_width},
             {.heading = "ratio", .left = true, .least = 7},
             {.heading = "", .left = true},
             {.heading = "ms", .least = 6},
             {.heading = "path m", .gap = 1, .least = 6}});
  std::size_t ratio = 0;
  for (const AnswerRow& row : table.rows) {
    if (!row.interval_text().empty()) ratio = std::max(ratio, display_width(row.ratio_text()));
  }
  const double most = table.most_checks();
  for (const AnswerRow& row : table.rows) {
    const std::string interval = row.interval_text();
    std::string cell = row.ratio_text();
    if (!interval.empty()) {
      cell = pad(cell, std::max<std::size_t>(ratio, 4), false);
      cell += ' ';
      cell += interval;
    }
    grid.add({shortened(std::string(2 * row.indent, ' ') + row.label, label), row.solved_text(), row.checks_text(),
              bar_width > 0 && table.rows.size() > 1 ? bar_of(row, most, bar_width) : "", std::move(cell),
              row.verdict.word, row.ms_text(), row.length_text()});
  }
  return grid;
}

/// Shortens names to a number of columns, so that they still differ: the end stays where the beginnings are the same.
std::vector<std::string> short_names(const std::vector<std::string>& names, std::size_t columns) {
  std::vector<std::string> all;
  for (const std::string& name : names) {
    std::string one = shortened(name, columns);
    const bool taken = std::any_of(names.begin(), names.end(), [&](const std::string& other) {
      return other != name && shortened(other, columns) == one;
    });
    if (taken) {
      std::string end = name;
      const auto first_point = [&] {
        std::size_t n = 1;
        while (n < end.size() && (static_cast<unsigned char>(end[n]) & 0xC0U) == 0x80U) ++n;
        return n;
      };
      while (display_width(end) + 1 > columns) end.erase(0, first_point());
      one = "…" + end;
    }
    all.push_back(std::move(one));
  }
  return all;
}

std::string matrix_text(const Answer& answer, std::size_t width) {
  constexpr std::size_t shortest = 6;
  constexpr std::size_t longest = 10;
  const AnswerMatrix& matrix = *answer.matrix;
  const auto grid_of = [&](std::size_t name, std::size_t label) {
    std::vector<Grid::Column> columns = {{.heading = "", .left = true}};
    for (const std::string& problem : short_names(matrix.problems, name)) {
      columns.push_back({.heading = problem, .gap = 1, .least = shortest});
    }
    columns.push_back({.heading = "", .left = true});
    Grid grid(std::move(columns));
    std::vector<std::string> cells = {shortened(matrix.reference, label - std::min<std::size_t>(label, 8)) +
                                      ", checks"};
    cells.insert(cells.end(), matrix.checks.begin(), matrix.checks.end());
    cells.emplace_back();
    grid.add(std::move(cells));
    const auto add = [&](const AnswerMatrix::Line& line) {
      std::vector<std::string> row = {shortened(line.label, label)};
      for (const AnswerMatrix::Cell& cell : line.cells) {
        const std::string text = cell.text();
        row.push_back(text.empty() || text.ends_with('~') ? text : text + ' ');
      }
      row.push_back(line.verdict.word);
      grid.add(std::move(row));
    };
    if (!matrix.strategies.empty()) grid.section(fmt::format("÷ {}'s", matrix.reference));
    for (const AnswerMatrix::Line& line : matrix.strategies) add(line);
    if (!matrix.guides.empty()) grid.section("a guide left out, ÷ the whole strategy's");
    for (const AnswerMatrix::Line& line : matrix.guides) add(line);
    return grid;
  };
  constexpr std::size_t label = 40;
  for (std::size_t name = longest; name > shortest; --name) {
    if (const Grid grid = grid_of(name, label); grid.width() <= width) return grid.text(width);
  }
  for (std::size_t shown = label; shown > label / 2; --shown) {
    if (const Grid grid = grid_of(shortest, shown); grid.width() <= width) return grid.text(width);
  }
  return grid_of(shortest, label / 2).text(width);
}

std::string groups_text(const AnswerGroups& groups, std::size_t width) {
  std::vector<Grid::Column> columns = {{.heading = groups.groups.empty() ? "" : "by group", .left = true}};
  for (const auto& [name, problems] : groups.groups) {
    columns.push_back({.heading = fmt::format("{} ({})", name, problems), .gap = 3, .least = 8});
  }
  columns.push_back({.heading = "cheaper", .gap = 3});
  columns.push_back({.heading = "10 … 90 % of runs", .left = true, .gap = 3});
  Grid grid(std::move(columns));
  for (const AnswerGroups::Line& line : groups.lines) {
    std::vector<std::string> cells = {line.strategy};
    for (const double ratio : line.ratios) cells.push_back(two_figures(ratio));
    cells.push_back(fmt::format("{} of {}", thousands(static_cast<double>(line.cheaper)),
                                thousands(static_cast<double>(line.runs))));
    cells.push_back(line.runs > 0 ? fmt::format("{} … {}", two_figures(line.lo), two_figures(line.hi)) : "");
    grid.add(std::move(cells));
  }
  return grid.text(width);
}

}  // namespace

std::string answer_table(const AnswerTable& table, std::size_t width) {
  constexpr std::size_t any_label = 1000;
  constexpr std::size_t least_label = 16;
  for (const std::size_t bars : {12U, 6U, 0U}) {
    if (const Grid grid = grid_of(table, bars, any_label); grid.width() <= width) return grid.text(width);
  }
  for (std::size_t label = width; label > least_label; --label) {
    if (const Grid grid = grid_of(table, 0, label); grid.width() <= width) return grid.text(width);
  }
  return grid_of(table, 0, least_label + least_label / 2).text(width);
}

std::string overview_text(const ExperimentSummary& experiment, std::size_t width) {
  constexpr std::size_t most_couplings = 16;
  const Answer& answer = experiment.answer;
  std::string out = wrap(answer.title, width, "", "  ") + '\n';
  out += answer.matrix ? matrix_text(answer, width) : answer_table(*answer.table(), width);
  out += '\n';
  bool legend = true;
  for (const AnswerNote& note : answer.notes) {
    if (legend && note.topic != "legend") {
      legend = false;
      if (answer.groups)
        out += (answer.notes.front().topic == "legend" ? "\n" : "") + groups_text(*answer.groups, width);
    }
    out += wrap(note.text, width, "", "  ");
  }
  for (const ProblemSummary* problem : experiment.listed()) {
    for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
      if (!experiment.strategies[s].ablation.empty()) continue;
      const std::string table =
          couplings_table(experiment.strategies[s], problem->strategies[s], width, most_couplings);
      if (!table.empty()) out += '\n' + (experiment.listed().size() > 1 ? problem->problem + ": " : "") + table;
    }
  }
  return out + '\n' + wrap(answer.next, width, "→ ", "  ") +
         wrap("more: --report levels, efficiency or full; `trellis help report` explains the columns", width, "  ",
              "  ");
}

}  // namespace trellis
