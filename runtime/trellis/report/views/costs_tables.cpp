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
#include <trellis/results/csv.hpp>

namespace trellis {

namespace {

using CostColumn = CostRatio CostComparison::*;

const std::vector<std::pair<const char*, CostColumn>>& cost_columns() {
  static const std::vector<std::pair<const char*, CostColumn>> all = {{"validity checks", &CostComparison::checks},
                                                                      {"CPU time", &CostComparison::seconds}};
  return all;
}

/// At least two significant digits.
std::string ratio_text(double x) {
  if (std::isnan(x)) return "-";
  if (std::isinf(x)) return x > 0.0 ? "inf" : "0";
  if (x == 0.0) return "0";
  const double size = std::abs(x);
  const int decimals = size >= 99.95 ? 0 : size >= 9.995 ? 1 : size >= 0.0995 ? 2 : 3;
  return fmt::format("{:.{}f}", x, decimals);
}

std::string range_text(const Interval& interval, const char* between) {
  if (std::isnan(interval.lo)) return "-";
  return ratio_text(interval.lo) + between + ratio_text(interval.hi);
}

std::string ratio_interval(const CostRatio& costs) {
  const Interval& ratio = costs.ratio;
  if (std::isnan(ratio.value)) return "-";
  if (std::isnan(ratio.lo)) return ratio_text(ratio.value);
  return fmt::format("{} [{}]", ratio_text(ratio.value), range_text(ratio, ", "));
}

std::string checks_text(double checks) {
  if (std::isnan(checks)) return "-";
  return std::isinf(checks) ? "inf" : fmt::format("{:.0f}", checks);
}

std::string milliseconds(double seconds) {
  if (std::isnan(seconds)) return "-";
  return std::isinf(seconds) ? "inf" : ratio_text(1000.0 * seconds);
}

/// Escapes the characters that have a meaning in Markdown.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (std::string_view("|\\`*_<>[]").find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

class Markdown {
 public:
  void line(const std::string& text) { text_ += text + "\n\n"; }
  void header(const std::vector<std::string>& cells) {
    if (!text_.ends_with("\n\n")) text_ += '\n';
    row(cells);
    text_ += "|---|";
    for (std::size_t i = 1; i < cells.size(); ++i) text_ += "---:|";
    text_ += '\n';
  }
  void row(const std::vector<std::string>& cells) {
    text_ += "|";
    for (const std::string& c : cells) text_ += fmt::format(" {} |", c);
    text_ += '\n';
  }
  void end() { text_ += '\n'; }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string worst_text(const CostSummary& summary) {
  if (std::isnan(summary.worst)) return "-";
  return fmt::format("{} ({})", ratio_text(summary.worst), escaped(summary.worst_problem));
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

struct Group {
  std::string name;
  bool tuned = false;
  std::vector<std::size_t> problems;
};

std::vector<Group> groups_of(const CostData& data) {
  std::vector<Group> groups;
  for (std::size_t p = 0; p < data.problems.size(); ++p) {
    const auto& problem = data.problems[p];
    const auto found =
        std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.name == problem.group; });
    if (found == groups.end()) {
      groups.push_back({problem.group, problem.tuned, {p}});
    } else {
      found->problems.push_back(p);
    }
  }
  return groups;
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

std::string heading(const Group& group) {
  return fmt::format("### {}, {}", group.name.empty() ? "problems of no group" : escaped(group.name),
                     group.tuned ? "tuned on" : "held out");
}

std::size_t seeds_of(const CostData& data) {
  std::set<std::uint64_t> seeds;
  for (const auto& run : data.runs) seeds.insert(run.seed);
  return seeds.size();
}

class Tables {
 public:
  Tables(const CostData& data, const std::string& baseline)
      : data_(data),
        baseline_(baseline),
        beside_baseline_(compare_costs(data, CostReference::baseline, baseline)),
        beside_planner_(compare_costs(data, CostReference::own_planner, baseline)),
        beside_parts_(compare_costs(data, CostReference::best_part, baseline)) {}

  std::string markdown() {
    out_.line("# Costs beside " + escaped(baseline_));
    out_.line(
        fmt::format("{}, {}, {}. A number is a strategy's cost divided by that of its "
                    "reference on the same seed, the median over the seeds; below 1 the strategy costs less. A "
                    "run without a path costs infinitely much; where neither finds one the ratio is 1.",
                    plural(data_.problems.size(), "problem"), plural_y(data_.strategies.size(), "strateg"),
                    plural(seeds_of(data_), "seed")));
    overall();
    if (!beside_planner_.empty()) {
      one_reference("Beside the planner without guides", "The reference is the strategy's own planner without guides.",
                    beside_planner_);
    }
    if (!beside_parts_.empty()) {
      one_reference("A composition beside its parts",
                    "The reference of `a >> b >> planner` is `a >> planner` or `b >> planner`, whichever costs less in "
                    "that world.",
                    beside_parts_);
    }
    correlation();
    out_.line("## World by world");
    out_.line(
        fmt::format("The reference is {}; its row has its medians. In brackets: the 95 % interval of the median by "
                    "order statistics. A fraction follows where some runs found no path.",
                    escaped(baseline_)));
    const bool grouped = !kinds_of(data_).front().name.empty();
    for (const Group& group : groups_of(data_)) {
      if (grouped) out_.line(heading(group));
      constexpr std::size_t most = 8;
      for (std::size_t first = 0; first < group.problems.size(); first += most) {
        const auto begin = group.problems.begin() + static_cast<std::ptrdiff_t>(first);
        const std::size_t count = std::min(most, group.problems.size() - first);
        const std::vector<std::size_t> some(begin, begin + static_cast<std::ptrdiff_t>(count));
        for (const auto& [name, quantity] : cost_columns()) matrix(some, name, quantity);
      }
    }
    every_figure();
    return out_.take();
  }

 private:
  void overall() {
    out_.line("## All worlds together");
    const std::vector<ProblemKind> kinds = kinds_of(data_);
    std::vector<std::string> names = {"strategy"};
    for (const ProblemKind& kind : kinds) {
      names.push_back(kind.name.empty() ? "solved" : "solved, " + kind.name);
      names.insert(names.end(), {"checks: median", "worst", "CPU time: median", "worst"});
    }
    out_.header(names);
    for (const std::size_t s : strategies_of(beside_baseline_)) {
      std::vector<std::string> cells = {"`" + data_.strategies[s].name + "`"};
      for (const ProblemKind& kind : kinds) {
        const CostSummary checks = summarise_costs(data_, beside_baseline_, s, &CostComparison::checks, kind.tuned);
        const CostSummary seconds = summarise_costs(data_, beside_baseline_, s, &CostComparison::seconds, kind.tuned);
        cells.insert(cells.end(), {share_text(checks.solved, checks.runs), ratio_text(checks.median),
                                   worst_text(checks), ratio_text(seconds.median), worst_text(seconds)});
      }
      out_.row(cells);
    }
    out_.end();
  }

  void one_reference(const std::string& title, const std::string& what, const std::vector<CostComparison>& all) {
    out_.line("## " + title);
    out_.line(what);
    out_.header({"strategy", "worlds", "solved", "checks: median", "worst", "CPU time: median", "worst"});
    for (const std::size_t s : strategies_of(all)) {
      const CostSummary checks = summarise_costs(data_, all, s, &CostComparison::checks);
      const CostSummary seconds = summarise_costs(data_, all, s, &CostComparison::seconds);
      out_.row({"`" + data_.strategies[s].name + "`", std::to_string(checks.problems),
                share_text(checks.solved, checks.runs), ratio_text(checks.median), worst_text(checks),
                ratio_text(seconds.median), worst_text(seconds)});
    }
    out_.end();
  }

  void correlation() {
    const auto found = cost_correlation(data_, baseline_);
    if (!found) return;
    out_.line("## Rank correlation of efficiency and checks");
    out_.line(escaped(correlation_explanation(*found, baseline_)));
    const auto rows = correlation_rows(data_, baseline_);
    out_.header({rows.front().begin(), rows.front().end()});
    for (std::size_t i = 1; i < rows.size(); ++i) out_.row({rows[i].begin(), rows[i].end()});
    out_.end();
  }

  [[nodiscard]] const CostComparison* find(std::size_t problem, std::size_t strategy) const {
    const auto found = std::find_if(beside_baseline_.begin(), beside_baseline_.end(), [&](const CostComparison& c) {
      return c.problem == problem && c.strategy == strategy;
    });
    return found == beside_baseline_.end() ? nullptr : &*found;
  }

  void matrix(const std::vector<std::size_t>& problems, const std::string& name, CostColumn quantity) {
    std::vector<std::string> cells = {name};
    for (const std::size_t p : problems) cells.push_back(escaped(data_.problems[p].name));
    out_.header(cells);
    cells = {"`" + baseline_ + "`"};
    for (const std::size_t p : problems) {
      const auto any = std::find_if(beside_baseline_.begin(), beside_baseline_.end(),
                                    [p](const CostComparison& c) { return c.problem == p; });
      if (any == beside_baseline_.end()) {
        cells.emplace_back("-");
        continue;
      }
      const CostRatio& costs = (*any).*quantity;
      const auto text = [&](double x) {
        return quantity == &CostComparison::checks ? checks_text(x) : milliseconds(x);
      };
      const Interval& median = costs.reference_median;
      const std::string unit = quantity == &CostComparison::checks ? "" : " ms";
      const std::string range = std::isnan(median.lo) || std::isnan(median.hi)
                                    ? ""
                                    : fmt::format(" [{}, {}]", text(median.lo), text(median.hi));
      cells.push_back(
          fmt::format("{}{}{}{}", text(median.value), range, unit, unsolved(costs.reference_solved, costs.pairs)));
    }
    out_.row(cells);
    for (const std::size_t s : strategies_of(beside_baseline_)) {
      cells = {"`" + data_.strategies[s].name + "`"};
      for (const std::size_t p : problems) {
        const CostComparison* c = find(p, s);
        cells.push_back(c == nullptr ? "-" : ratio_interval(c->*quantity) + unsolved(c->solved, c->runs));
      }
      out_.row(cells);
    }
    out_.end();
  }

  static std::string unsolved(std::size_t solved, std::size_t runs) {
    return solved == runs ? "" : fmt::format(" {}/{}", solved, runs);
  }

  void every_figure() {
    out_.line("## Every figure");
    out_.line(
        "Solved: by the strategy, by the reference, by both on one seed. Totals: of all seeds, which a few long runs "
        "decide. p: sign test, corrected by Holm over all rows.");
    out_.header({"world", "group", "strategy", "solved", "reference", "both", "checks", "ratio of medians",
                 "ratio of totals", "median ratio", "95 % interval", "p", "CPU ms", "ratio of medians",
                 "ratio of totals", "median ratio", "95 % interval", "p"});
    for (const CostComparison& c : beside_baseline_) {
      const auto& problem = data_.problems[c.problem];
      const auto range = [](const CostRatio& r) { return range_text(r.ratio, " – "); };
      const auto p = [](const CostRatio& r) { return r.pairs > 0 ? p_text(r.holm_p) : "-"; };
      out_.row({escaped(problem.name), escaped(problem.group), "`" + data_.strategies[c.strategy].name + "`",
                share_text(c.solved, c.runs), share_text(c.checks.reference_solved, c.checks.pairs),
                share_text(c.checks.both_solved, c.checks.pairs), checks_text(c.checks.median.value),
                ratio_text(c.checks.ratio_of_medians()), ratio_text(c.checks.ratio_of_totals()),
                ratio_text(c.checks.ratio.value), range(c.checks), p(c.checks), milliseconds(c.seconds.median.value),
                ratio_text(c.seconds.ratio_of_medians()), ratio_text(c.seconds.ratio_of_totals()),
                ratio_text(c.seconds.ratio.value), range(c.seconds), p(c.seconds)});
    }
  }

  const CostData& data_;
  const std::string& baseline_;
  std::vector<CostComparison> beside_baseline_;
  std::vector<CostComparison> beside_planner_;
  std::vector<CostComparison> beside_parts_;
  Markdown out_;
};

std::string csv_number(double x) {
  if (std::isnan(x)) return "";
  if (std::isinf(x)) return x > 0.0 ? "inf" : "-inf";
  return fmt::format("{}", x);
}

}  // namespace

std::string costs_text(const CostData& data, const std::string& baseline, std::size_t width) {
  const auto comparisons = compare_costs(data, CostReference::baseline, baseline);
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

std::string costs_markdown(const CostData& data, const std::string& baseline) {
  return Tables(data, baseline).markdown();
}

std::string costs_csv(const CostData& data, const std::string& baseline) {
  std::string out =
      "group,tuned,problem,strategy,against,reference,quantity,runs,solved,reference_solved,both_solved,median,"
      "reference_median,"
      "ratio_of_medians,ratio_of_totals,paired_ratio,lo,hi,sign_p,holm_p,effect\n";
  const std::vector<std::pair<const char*, CostReference>> references = {{"baseline", CostReference::baseline},
                                                                         {"own_planner", CostReference::own_planner},
                                                                         {"best_part", CostReference::best_part}};
  const std::vector<std::pair<const char*, CostColumn>> columns = {{"validity_checks", &CostComparison::checks},
                                                                   {"cpu_s", &CostComparison::seconds}};
  for (const auto& [against, reference] : references) {
    for (const CostComparison& c : compare_costs(data, reference, baseline)) {
      const auto& problem = data.problems[c.problem];
      for (const auto& [name, quantity] : columns) {
        const CostRatio& r = c.*quantity;
        out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_text(problem.group),
                           problem.tuned, csv_text(problem.name), csv_text(data.strategies[c.strategy].name), against,
                           csv_text(r.reference), name, c.runs, c.solved, r.reference_solved, r.both_solved,
                           csv_number(r.median.value), csv_number(r.reference_median.value),
                           csv_number(r.ratio_of_medians()), csv_number(r.ratio_of_totals()), csv_number(r.ratio.value),
                           csv_number(r.ratio.lo), csv_number(r.ratio.hi), csv_number(r.sign_p), csv_number(r.holm_p),
                           csv_number(r.effect));
      }
    }
  }
  return out;
}

}  // namespace trellis
