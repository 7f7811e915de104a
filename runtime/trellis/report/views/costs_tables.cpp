// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <trellis/report/cost_correlation.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

/// At least two significant digits.
std::string ratio_text(double x) {
  if (std::isnan(x)) return "-";
  if (std::isinf(x)) return x > 0.0 ? "inf" : "0";
  if (x == 0.0) return "0";
  const double size = std::abs(x);
  const int decimals = size >= 99.95 ? 0 : size >= 9.995 ? 1 : size >= 0.0995 ? 2 : 3;
  return fmt::format("{:.{}f}", x, decimals);
}

std::string share_text(std::size_t solved, std::size_t runs) {
  return runs == 0 ? "-" : fmt::format("{}/{}", solved, runs);
}

/// Returns the strategies of the comparisons, in their order.
std::vector<std::size_t> strategies_of(const std::vector<CostComparison>& comparisons) {
  std::set<std::size_t> found;
  for (const auto& c : comparisons) found.insert(c.strategy);
  return {found.begin(), found.end()};
}

/// Problems that a table sums up side by side: those that the strategies were tuned on and those held out. Without
/// groups, all.
struct ProblemKind {
  std::string name;  ///< "": all
  std::optional<bool> tuned;
};

std::vector<ProblemKind> kinds_of(const CostData& data) {
  const auto grouped = [](const CostData::Problem& problem) { return !problem.group.empty(); };
  if (std::none_of(data.problems.begin(), data.problems.end(), grouped)) return {{"", std::nullopt}};
  std::vector<ProblemKind> kinds;
  for (const auto& [name, tuned] : {std::pair{"tuned on", true}, std::pair{"held out", false}}) {
    const auto is = [&, kind = tuned](const CostData::Problem& problem) { return problem.tuned == kind; };
    if (std::any_of(data.problems.begin(), data.problems.end(), is)) kinds.push_back({name, tuned});
  }
  return kinds;
}

std::size_t seeds_of(const CostData& data) {
  std::set<std::uint64_t> seeds;
  for (const auto& run : data.runs) seeds.insert(run.seed);
  return seeds.size();
}

}  // namespace

std::string costs_text(const CostData& data, const std::string& baseline, std::size_t width) {
  const auto comparisons = compare_costs(data, baseline);
  std::vector<Table::Column> columns = {{{"strategy"}, "", true}};
  const std::vector<ProblemKind> kinds = kinds_of(data);
  for (const ProblemKind& kind : kinds) {
    columns.push_back({{"solved"}, kind.name});
    for (const char* quantity : {"checks", "CPU"}) {
      columns.push_back({{quantity, "median"}, kind.name});
      columns.push_back({{quantity, "worst"}, kind.name});
    }
  }
  Table table(std::move(columns));
  for (const std::size_t s : strategies_of(comparisons)) {
    std::vector<std::string> cells = {data.strategies[s].name};
    for (const ProblemKind& kind : kinds) {
      const CostSummary checks = summarise_costs(data, comparisons, s, &CostComparison::checks, kind.tuned);
      const CostSummary seconds = summarise_costs(data, comparisons, s, &CostComparison::seconds, kind.tuned);
      cells.insert(cells.end(), {share_text(checks.solved, checks.runs), ratio_text(checks.median),
                                 ratio_text(checks.worst), ratio_text(seconds.median), ratio_text(seconds.worst)});
    }
    table.add(std::move(cells));
  }
  std::string text =
      fmt::format("costs divided by those of {}, {}, {}\n\n{}", baseline, plural(data.problems.size(), "problem"),
                  plural(seeds_of(data), "seed"), table.text(width));
  if (const auto found = cost_correlation(data, baseline)) {
    const auto rows = correlation_rows(data, baseline);
    std::vector<Table::Column> headings;
    for (const std::string& heading : rows.front()) headings.push_back({{heading}, "", true});
    Table correlations(std::move(headings));
    for (std::size_t i = 1; i < rows.size(); ++i) correlations.add({rows[i].begin(), rows[i].end()});
    text += fmt::format("\n{}\n{}", wrap(correlation_explanation(*found, baseline), width), correlations.text(width));
  }
  return text;
}

}  // namespace trellis
