// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include <trellis/draw/ratios.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/directories.hpp>
#include <trellis/report/pictures.hpp>

namespace trellis {

namespace {

/// The groups in the order of the problems: circles for those that the strategies were tuned on, discs for the others.
std::vector<draw::RatioGroup> groups_of(const CostData& data, std::vector<std::size_t>& group_of_problem) {
  std::vector<draw::RatioGroup> groups;
  std::map<std::string, std::size_t> known;
  for (const auto& problem : data.problems) {
    const auto [found, fresh] = known.emplace(problem.group, groups.size());
    if (fresh) {
      const std::string name = problem.group.empty() ? "no group" : problem.group;
      groups.push_back({fmt::format("{} ({})", name, problem.tuned ? "tuned on" : "held out"),
                        draw::palette::nth(groups.size()), problem.tuned});
    }
    group_of_problem.push_back(found->second);
  }
  return groups;
}

draw::RatioDot dot(const CostData& data, const CostComparison& c, const CostRatio& ratio, std::size_t group) {
  return {group, data.problems[c.problem].name, ratio.ratio.value, ratio.ratio.lo, ratio.ratio.hi};
}

void write(const CostData& data, const std::vector<CostComparison>& comparisons, draw::RatioFigure figure,
           const std::string& stem) {
  if (comparisons.empty()) return;
  std::vector<std::size_t> group_of;
  figure.groups = groups_of(data, group_of);
  figure.panels = {"validity checks, all levels", "CPU time"};
  figure.x_label = "cost / cost of the reference (left of 1: costs less)";
  std::map<std::size_t, draw::RatioRow> rows;
  for (const CostComparison& c : comparisons) {
    draw::RatioRow& row = rows[c.strategy];
    row.name = data.strategies[c.strategy].name;
    row.panels.resize(2);
    row.panels[0].push_back(dot(data, c, c.checks, group_of[c.problem]));
    row.panels[1].push_back(dot(data, c, c.seconds, group_of[c.problem]));
  }
  for (auto& [strategy, row] : rows) figure.rows.push_back(std::move(row));
  write_picture(draw::plot(figure), stem);
}

constexpr const char* how_to_read =
    "A dot is a world: the median over the seeds of the strategy's cost divided by the reference's on the same seed, "
    "with its 99 % interval. A run without a path costs infinitely much. Left of 1 the strategy costs less. An arrow "
    "to "
    "the right: most of its runs found no path; to the left: most of the reference's. The world with the largest ratio "
    "of a row has its name beside it.";

}  // namespace

void write_cost_figures(const CostData& data, const std::string& baseline, const std::string& folder) {
  make_directory(folder);
  const auto stem = [&](const char* name) { return (std::filesystem::path(folder) / name).string(); };
  constexpr double bounded_loss = 2.2;
  constexpr double of_parts = 1.3;
  write(data, compare_costs(data, CostReference::baseline, baseline),
        {.title = fmt::format("Does guidance pay? Costs beside {} without guides", baseline),
         .caption = how_to_read,
         .lines = {{1.0, "as without guides", draw::Dash::solid}, {bounded_loss, "2.2 times", draw::Dash::dashed}}},
        stem("baseline"));
  write(data, compare_costs(data, CostReference::own_planner, baseline),
        {.title = "What can a guide lose? Costs beside the same planner without guides",
         .caption = how_to_read,
         .lines = {{1.0, "as without guides", draw::Dash::solid}, {bounded_loss, "2.2 times", draw::Dash::dashed}}},
        stem("own_planner"));
  write(data, compare_costs(data, CostReference::best_part, baseline),
        {.title = "Does nesting pay? Costs of a >> b beside the better one of a and b",
         .caption = how_to_read,
         .lines = {{1.0, "as the better part", draw::Dash::solid}, {of_parts, "1.3 times", draw::Dash::dashed}}},
        stem("parts"));
}

}  // namespace trellis
