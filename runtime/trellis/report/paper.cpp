// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of an experiment in the layout of papers: strategies below each other, problems side by side.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/verdict.hpp>
#include <trellis/report/words.hpp>
#include <trellis/results/csv.hpp>
#include <trellis/results/facts.hpp>

namespace trellis {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* headline = "headline";

using Role = Efficiency Scores::*;
using Where = std::optional<Scores> LevelScores::*;

struct NamedRole {
  const char* name;
  Role role;
};
const std::vector<NamedRole>& roles() {
  static const std::vector<NamedRole> all = {{"tree", &Scores::tree}, {"expansion", &Scores::expansion}};
  return all;
}

struct NamedPath {
  const char* name;   ///< in files
  const char* title;  ///< in headings
  Where where;        ///< nullptr: all seeds together, on the paths of seeds left out
  FigurePair LevelSummary::*pair;
};
/// The paths on which single runs are scored.
const std::vector<NamedPath>& paths() {
  static const std::vector<NamedPath> all = {
      {"own", "own path", &LevelScores::root, &LevelSummary::root},
      {"cross", "other seeds' paths", &LevelScores::root_cross, &LevelSummary::root_cross}};
  return all;
}
constexpr NamedPath together = {"pooled", "all seeds together", nullptr, nullptr};

/// Returns the estimators with results: the headline's, then the other requested ones.
std::vector<std::string> estimators_of(const ExperimentFacts& experiment) {
  std::vector<std::string> names = {headline};
  names.insert(names.end(), experiment.estimators.begin(), experiment.estimators.end());
  return names;
}

const Efficiency* efficiency_of(const RunFacts& run, Where where, Role role) {
  return run.levels.empty() ? nullptr : run.levels.front().score(where, role);
}

/// Returns SE by an estimator; NaN where it has none.
double value_by(const Efficiency& efficiency, const std::string& estimator) {
  const Estimate* found = nullptr;
  if (estimator == headline || efficiency.estimator == estimator) found = &efficiency;
  for (const Estimate& other : efficiency.others) {
    if (found == nullptr && other.estimator == estimator) found = &other;
  }
  return found != nullptr ? found->value : nan;
}

/// Returns one value per run, NaN where a run has none.
template <class Value>
std::vector<double> per_run(const std::vector<const RunFacts*>& runs, Where where, Role role, Value value) {
  std::vector<double> values;
  values.reserve(runs.size());
  for (const RunFacts* run : runs) {
    const Efficiency* e = efficiency_of(*run, where, role);
    values.push_back(e != nullptr ? value(*e) : nan);
  }
  return values;
}

std::string fixed(double x, int decimals = 2) {
  std::string text = fmt::format("{:.{}f}", x, decimals);
  if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

/// "1.23 ± 0.08", "1.23" without an interval, "NA" for a missing value; states the number of infinite values.
std::string cell(const Interval& interval) {
  if (std::isnan(interval.value)) return "NA";
  if (std::isinf(interval.value)) {
    return fmt::format("inf ({}/{})", interval.infinite, interval.infinite + interval.n);
  }
  std::string text = fixed(interval.value);
  if (std::isfinite(interval.hi)) text += " ± " + fixed(0.5 * (interval.hi - interval.lo));
  if (interval.infinite > 0) text += fmt::format(" ({} inf)", interval.infinite);
  return text;
}

/// A value with a bound, which is a mean over the same runs.
struct Bounded {
  Interval interval;    ///< clipped at the bound
  Interval estimate;    ///< not clipped
  bool beyond = false;  ///< the mean of the estimates lies beyond the bound and is replaced by it
  const char* sign = "≥ ";
};

Bounded bounded(Interval interval, double least) {
  constexpr double visible = 0.005;  // half of the last printed digit
  Bounded result{interval, interval, interval.value < least - visible};
  if (std::isnan(least)) return result;
  for (double* x : {&result.interval.value, &result.interval.lo, &result.interval.hi}) {
    if (*x < least) *x = least;
  }
  return result;
}

/// The same with an upper bound.
Bounded bounded_above(const Interval& interval, double most) {
  const auto negative = [](Interval x) {
    x.value = -x.value;
    std::swap(x.lo, x.hi);
    x.lo = -x.lo;
    x.hi = -x.hi;
    return x;
  };
  Bounded result = bounded(negative(interval), -most);
  result.interval = negative(result.interval);
  result.estimate = interval;
  result.sign = "≤ ";
  return result;
}

/// "0.42 to 1.20", the SE that the samples support; "blank" where they support none.
std::string cell(const AboveUniform& above, double uniform) {
  if (std::isnan(above.lo)) return "NA";
  if (!above.printed()) return "blank";
  const std::string lo = fixed(uniform - above.hi);
  const std::string hi = fixed(uniform - above.lo);
  return lo == hi ? lo : lo + " to " + hi;
}

/// "-0.42 to 1.20", the nats above uniform that the samples support; "blank" where they support none.
std::string ends(const AboveUniform& above) {
  if (std::isnan(above.lo)) return "NA";
  if (!above.printed()) return "blank";
  return fixed(above.lo) == fixed(above.hi) ? fixed(above.lo) : fixed(above.lo) + " to " + fixed(above.hi);
}

/// Returns "≥ 0.05" where only the bound is available.
std::string cell(const Bounded& figure) {
  return figure.beyond ? figure.sign + fixed(figure.interval.value) : cell(figure.estimate);
}

/// "20400<br>[18000, 24000]", a median with its interval, in the unit of `text`; without an interval the median alone.
template <class Text>
std::string median_cell(const Interval& median, const Text& text) {
  if (std::isnan(median.lo) || std::isnan(median.hi)) return text(median.value);
  return fmt::format("{}<br>[{}, {}]", text(median.value), text(median.lo), text(median.hi));
}

/// Returns the lower bound of an estimator's value for a run: from the mass in the target, or 0 where it is no
/// estimate.
double least_by(const Efficiency& efficiency, const std::string& estimator) {
  const std::string& name = estimator == headline ? efficiency.estimator : estimator;
  if (name.starts_with("exact")) return 0.0;
  return least_value(efficiency);
}

/// Escapes the characters that have a meaning in Markdown.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (std::string_view("|\\`*_<>[]").find(c) != std::string_view::npos) result += '\\';
    result += c == '\n' || c == '\r' ? ' ' : c;
  }
  return result;
}

class Markdown {
 public:
  void heading(const std::string& text) { text_ += fmt::format("\n## {}\n\n", text); }
  void paragraph(const std::string& text) { text_ += text + "\n\n"; }
  void header(const std::vector<std::string>& cells) {
    row(cells);
    text_ += "|";
    for (std::size_t i = 0; i < cells.size(); ++i) text_ += "---|";
    text_ += '\n';
  }
  void row(const std::vector<std::string>& cells) {
    text_ += "|";
    for (const std::string& c : cells) text_ += fmt::format(" {} |", c);
    text_ += '\n';
  }
  [[nodiscard]] std::string take() { return std::move(text_); }
  std::string& text() { return text_; }

 private:
  std::string text_;
};

class Tables {
 public:
  Tables(const ExperimentFacts& experiment, const ExperimentSummary& summary)
      : experiment_(experiment), estimators_(estimators_of(experiment)) {
    for (const ProblemSummary& problem : summary.problems) {
      for (const StrategySummary& one : problem.strategies) {
        summaries_.emplace(std::pair(problem.problem, one.strategy), &one.runs);
      }
    }
    if (std::any_of(summaries_.begin(), summaries_.end(), [](const auto& entry) {
          const std::vector<LevelSummary>& levels = entry.second->levels;
          return !levels.empty() && trellis::headline(levels.front(), SampleRole::tree).seeds > 0;
        })) {
      paths_.push_back(together);
    }
    paths_.insert(paths_.end(), paths().begin(), paths().end());
  }

  std::string markdown() {
    head();
    for (const NamedPath& path : paths_) layout(path, headline);
    if (paths_.size() > paths().size()) disagreements();
    if (experiment_.measured) sample_ranks();
    for (const ProblemFacts& problem : experiment_.problems) others(problem);
    for (std::size_t i = 1; i < estimators_.size(); ++i) {
      for (const NamedPath& path : paths_) layout(path, estimators_[i]);
    }
    return page_.take();
  }

  std::string csv() {
    std::string text = "problem,strategy,role,path,estimator,quantity,value,lo,hi,n,infinite\n";
    const auto add = [&](const std::string& problem, const std::string& strategy, const std::string& role,
                         const char* path, const std::string& estimator, const char* quantity, const Interval& x) {
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", csv_text(problem), csv_text(strategy), csv_text(role), path,
                      csv_text(estimator), quantity, number(x.value), number(x.lo), number(x.hi), x.n, x.infinite);
    };
    const std::vector<GuideVerdict> verdicts = guide_verdicts(experiment_, false);
    for (const ProblemFacts& problem : experiment_.problems) {
      for (const StrategyFacts& strategy : experiment_.strategies) {
        const std::string& name = strategy.name;
        const auto chosen = experiment_.select(problem.name, name);
        const RunsSummary& summary = summary_of(problem.name, name);
        add(problem.name, name, "", "", "", "success", summary.success);
        add(problem.name, name, "", "", "", "length", summary.length);
        add(problem.name, name, "", "", "", "validity_checks", summary.validity_checks);
        for (const GuideVerdict& one : verdicts) {
          if (one.problem != problem.name || one.strategy != name) continue;
          const auto& [median, interval] = one.verdict.ratio;
          // The median is known where most runs without the guide were not cut off.
          const Interval ratio{median.lo == median.hi ? median.lo : std::numeric_limits<double>::quiet_NaN(),
                               interval.lo, interval.hi, one.verdict.counts.pairs};
          if (ratio.n > 0) add(problem.name, name, one.guide, "", "", "checks_with_to_without", ratio);
        }
        for (const NamedRole& role : roles()) {
          for (const NamedPath& path : paths_) {
            for (const std::string& estimator : estimators_) {
              add(problem.name, name, role.name, path.name, estimator, "SE",
                  estimator == headline ? supported(problem.name, name, path, role)
                                        : shown_figure(problem.name, name, path, role, estimator).interval);
            }
            if (path.where == nullptr) continue;
            for (const Quantity& quantity : quantities()) {
              add(problem.name, name, role.name, path.name, headline, quantity.name,
                  shown_quantity(chosen, path.where, role.role, quantity).interval);
            }
          }
        }
      }
    }
    return text;
  }

 private:
  struct Quantity {
    const char* name;
    const char* title;
    double (*field)(const Efficiency&);
    /// Returns its lower bound for a run; nullptr: it is no divergence.
    double (*least)(const Efficiency&) = nullptr;
    /// Returns its upper bound; nullptr: none.
    double (*most)(const Efficiency&) = nullptr;
  };
  static double zero(const Efficiency& /*efficiency*/) { return 0.0; }
  static const std::vector<Quantity>& quantities() {
    static const std::vector<Quantity> all = {
        {"N", "N", [](const Efficiency& e) { return static_cast<double>(e.samples); }},
        {"n", "in target", [](const Efficiency& e) { return static_cast<double>(e.in_target); }},
        {"D_uniform", "uniform", [](const Efficiency& e) { return e.uniform; }},
        {"D_perfect", "perfect", [](const Efficiency& e) { return e.perfect; }},
        {"D", "D", [](const Efficiency& e) { return e.unregularised; },
         [](const Efficiency& e) { return e.mass_lower95; }},
        {"SE_parts.mass", "mass", [](const Efficiency& e) { return e.parts.mass; }, zero},
        {"SE_parts.spread", "spread", [](const Efficiency& e) { return e.parts.spread; }, zero},
        {"D_mass_lower95", "D at least", [](const Efficiency& e) { return e.mass_lower95; }},
        {"along.D", "along", [](const Efficiency& e) { return e.along.divergence; }, zero},
        {"coverage", "coverage", [](const Efficiency& e) { return e.coverage; }}};
    return all;
  }

  static std::string number(double x) {
    if (std::isnan(x)) return "";
    if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
    return fmt::format("{}", x);
  }

  [[nodiscard]] const RunsSummary& summary_of(const std::string& problem, const std::string& strategy) const {
    return *summaries_.at({problem, strategy});
  }

  /// The samples of all seeds of a strategy; nullptr without.
  [[nodiscard]] const Efficiency* pooled(const std::string& problem, const std::string& strategy,
                                         const NamedRole& role) const {
    const RunsSummary& summary = summary_of(problem, strategy);
    if (summary.levels.empty() || !summary.levels.front().pooled) return nullptr;
    const PooledSummary& of = *summary.levels.front().pooled;
    return role.role == &Scores::tree ? &of.tree : &of.expansion;
  }

  /// What the samples support, and the divergence of uniform sampling.
  [[nodiscard]] std::pair<AboveUniform, double> above(const std::string& problem, const std::string& strategy,
                                                      const NamedPath& path, const NamedRole& role) const {
    if (path.where == nullptr) {
      const Efficiency* e = pooled(problem, strategy, role);
      if (e == nullptr) return {AboveUniform{}, nan};
      return {above_uniform(*e), e->uniform};
    }
    const RunsSummary& summary = summary_of(problem, strategy);
    if (summary.levels.empty()) return {AboveUniform{}, nan};
    const FigurePair& pair = summary.levels.front().*path.pair;
    const Figure& of = role.role == &Scores::tree ? pair.tree : pair.expansion;
    return {above_uniform(of), of["D_uniform"].value};
  }
  [[nodiscard]] std::string supported_cell(const std::string& problem, const std::string& strategy,
                                           const NamedPath& path, const NamedRole& role) const {
    const auto& [found, uniform] = above(problem, strategy, path, role);
    return cell(found, uniform);
  }
  /// SE as the samples support it: its ends, and the middle as the value; without a value where it is blank.
  [[nodiscard]] Interval supported(const std::string& problem, const std::string& strategy, const NamedPath& path,
                                   const NamedRole& role) const {
    const auto& [found, uniform] = above(problem, strategy, path, role);
    const double lo = uniform - found.hi;
    const double hi = uniform - found.lo;
    return {found.printed() ? 0.5 * (lo + hi) : nan, lo, hi, scored(problem, strategy, path, role), 0};
  }
  [[nodiscard]] std::size_t scored(const std::string& problem, const std::string& strategy, const NamedPath& path,
                                   const NamedRole& role) const {
    const RunsSummary& summary = summary_of(problem, strategy);
    if (summary.levels.empty()) return 0;
    const LevelSummary& root = summary.levels.front();
    if (path.where == nullptr) return root.pooled ? root.pooled->seeds + 1 : 0;
    const FigurePair& pair = root.*path.pair;
    return role.role == &Scores::tree ? pair.tree.scored : pair.expansion.scored;
  }

  /// The estimate, for comparisons; of the headline the middle of the interval that the samples support.
  [[nodiscard]] double compared(const std::string& problem, const std::string& strategy, const NamedPath& path,
                                const NamedRole& role, const std::string& estimator) const {
    return estimator == headline ? supported(problem, strategy, path, role).value
                                 : figure(problem, strategy, path, role, estimator).value;
  }

  [[nodiscard]] Interval figure(const std::string& problem, const std::string& strategy, const NamedPath& path,
                                const NamedRole& role, const std::string& estimator) const {
    if (path.where == nullptr) {
      const Efficiency* e = pooled(problem, strategy, role);
      return {e != nullptr ? value_by(*e, estimator) : nan, nan, nan, scored(problem, strategy, path, role), 0};
    }
    return student_interval(per_run(experiment_.select(problem, strategy), path.where, role.role,
                                    [&](const Efficiency& e) { return value_by(e, estimator); }));
  }

  /// The printed value: never below the bound from the runs' masses in the target.
  [[nodiscard]] Bounded shown_figure(const std::string& problem, const std::string& strategy, const NamedPath& path,
                                     const NamedRole& role, const std::string& estimator) const {
    if (path.where == nullptr) {
      const Efficiency* e = pooled(problem, strategy, role);
      return bounded(figure(problem, strategy, path, role, estimator), e != nullptr ? least_by(*e, estimator) : nan);
    }
    const auto least = per_run(experiment_.select(problem, strategy), path.where, role.role, [&](const Efficiency& e) {
      return std::isnan(value_by(e, estimator)) ? nan : least_by(e, estimator);
    });
    return bounded(figure(problem, strategy, path, role, estimator), student_interval(least).value);
  }

  static Bounded shown_quantity(const std::vector<const RunFacts*>& runs, Where where, Role role,
                                const Quantity& quantity) {
    const auto over_runs = [&](double (*field)(const Efficiency&)) {
      return student_interval(per_run(runs, where, role, [field](const Efficiency& e) { return field(e); }));
    };
    const Interval figure = over_runs(quantity.field);
    if (quantity.most != nullptr) return bounded_above(figure, over_runs(quantity.most).value);
    return bounded(figure, quantity.least != nullptr ? over_runs(quantity.least).value : nan);
  }

  void head() {
    page_.text() = "# Sampling efficiency\n\n";
    page_.paragraph(fmt::format(
        "{} problem{}, {} strateg{}, {} seeds. SE: divergence of the target from the root's samples with 5 % uniform "
        "mixed in, nats, lower is better: the 95 % interval that the samples support, one number where recorded "
        "densities determine it. blank: the samples do not show on which side of uniform sampling they are. Upper "
        "value: tree; lower value: expansion (NA: the strategy makes no proposals, or no run has a figure). Other "
        "values: mean ± half-width of the 95 % Student interval over the runs; ≥ and ≤: a bound stands for the mean, "
        "because the mean of the estimates lies beyond what the mass in the target allows.",
        experiment_.problems.size(), experiment_.problems.size() == 1 ? "" : "s", experiment_.strategies.size(),
        experiment_.strategies.size() == 1 ? "y" : "ies", experiment_.seeds.size()));
    for (const ProblemFacts& problem : experiment_.problems) {
      std::vector<std::string> none;
      for (const StrategyFacts& strategy : experiment_.strategies) {
        const std::string& name = strategy.name;
        if (summary_of(problem.name, name).solved == 0) none.push_back(escaped(name));
      }
      if (none.empty()) continue;
      page_.paragraph(
          none.size() == experiment_.strategies.size()
              ? fmt::format("**{}**: no run found a path, so there is no target and no figure.", escaped(problem.name))
              : fmt::format("**{}**: no run of {} found a path; figures are on other strategies' paths only.",
                            escaped(problem.name), fmt::join(none, ", ")));
    }
  }

  [[nodiscard]] std::vector<std::string> problem_header(const std::string& first) const {
    std::vector<std::string> cells = {first};
    for (const ProblemFacts& problem : experiment_.problems) cells.push_back(escaped(problem.name));
    return cells;
  }

  /// The paper's layout: upper value tree, lower value expansion.
  void layout(const NamedPath& path, const std::string& estimator) {
    page_.heading(estimator == headline ? fmt::format("SE, {}", path.title)
                                        : fmt::format("SE by {}, {}", escaped(estimator), path.title));
    page_.header(problem_header("strategy"));
    for (const StrategyFacts& strategy : experiment_.strategies) {
      const std::string& name = strategy.name;
      std::vector<std::string> cells = {escaped(name)};
      for (const ProblemFacts& problem : experiment_.problems) {
        const auto of = [&](const NamedRole& role) {
          return estimator == headline ? supported_cell(problem.name, name, path, role)
                                       : cell(shown_figure(problem.name, name, path, role, estimator));
        };
        cells.push_back(of(roles()[0]) + "<br>" + of(roles()[1]));
      }
      page_.row(cells);
    }
    page_.text() += '\n';
  }

  /// Says where the samples of all seeds together and those of single runs disagree, on other seeds' paths.
  void disagreements() {
    constexpr double visible = 0.05;  // nats: targets differ
    page_.heading("Where all seeds together and single runs disagree");
    std::vector<std::vector<std::string>> rows;
    for (const ProblemFacts& problem : experiment_.problems) {
      for (const StrategyFacts& strategy : experiment_.strategies) {
        const std::string& name = strategy.name;
        for (const NamedRole& role : roles()) {
          const RunsSummary& summary = summary_of(problem.name, name);
          if (summary.levels.empty()) continue;
          const AboveUniform all = above(problem.name, name, together, role).first;
          const AboveUniform single = above(problem.name, name, paths().back(), role).first;
          const FigurePair& pair = summary.levels.front().root_cross;
          const Interval& estimate =
              role.role == &Scores::tree ? pair.tree["above_uniform"] : pair.expansion["above_uniform"];
          // Their paths differ, so nats above uniform are compared.
          if (!all.printed() || !(estimate.hi < all.lo - visible || estimate.lo > all.hi + visible)) continue;
          rows.push_back({escaped(problem.name), escaped(name), role.name, ends(all), ends(single), cell(estimate)});
        }
      }
    }
    if (rows.empty()) {
      page_.paragraph("Nowhere: the estimates of single runs lie in the intervals of all seeds together.");
      return;
    }
    page_.paragraph(
        "Nats above uniform, more is better. The mean of the estimates of single runs, on other seeds' paths, lies "
        "with its "
        "interval outside of what all seeds together support. Below it, single runs miss parts of the target that a "
        "mixture of them covers; above "
        "it, so few samples do not show how thin they are.");
    page_.header({"problem", "strategy", "samples", "all seeds together", "single runs", "estimate of single runs"});
    for (const auto& cells : rows) page_.row(cells);
    page_.text() += '\n';
  }

  void others(const ProblemFacts& problem) {
    page_.heading(fmt::format("Other measures, {}", escaped(problem.name)));
    page_.paragraph(
        "On other seeds' paths (own path where there are none); upper value tree, lower value expansion. Solved: with "
        "Wilson's 95 % interval; validity checks and time: medians over all runs, an unsolved one infinite, with 95 % "
        "intervals by order statistics.");
    std::vector<std::string> header = {"strategy", "solved", "validity checks", "time, ms"};
    for (const Quantity& quantity : quantities()) header.emplace_back(quantity.title);
    page_.header(header);
    for (const StrategyFacts& strategy : experiment_.strategies) {
      const std::string& name = strategy.name;
      const auto chosen = experiment_.select(problem.name, name);
      const RunsSummary& summary = summary_of(problem.name, name);
      const bool crossed = std::any_of(chosen.begin(), chosen.end(), [](const RunFacts* run) {
        return !run->levels.empty() && run->levels.front().scores && run->levels.front().scores->root_cross;
      });
      const bool none = summary.runs == 0;
      std::vector<std::string> cells = {
          escaped(name),
          none ? "NA" : fmt::format("{}/{}<br>{} %", summary.solved, summary.runs, wilson_text(summary.success)),
          none ? "NA" : median_cell(summary.validity_checks, count_text),
          none ? "NA" : median_cell(summary.seconds, [](double x) { return milliseconds_text(x, 2); })};
      for (const Quantity& quantity : quantities()) {
        std::string both;
        for (const NamedRole& role : roles()) {
          both += (both.empty() ? "" : "<br>") +
                  cell(shown_quantity(chosen, paths()[crossed ? 1 : 0].where, role.role, quantity));
        }
        cells.push_back(std::move(both));
      }
      page_.row(cells);
    }
    page_.text() += '\n';
  }

  /// Returns the mean number of samples over the runs. All seeds together: on other seeds' paths.
  [[nodiscard]] double samples(const std::string& problem, const std::string& strategy, const NamedPath& path,
                               const NamedRole& role) const {
    const Where where = path.where != nullptr ? path.where : paths().back().where;
    return student_interval(per_run(experiment_.select(problem, strategy), where, role.role,
                                    [](const Efficiency& e) { return static_cast<double>(e.samples); }))
        .value;
  }

  /// Writes a section, if it has rows: one row for each estimator, path and role, one column for each problem.
  void sample_ranks() {
    std::vector<std::vector<std::string>> rows;
    for (const std::string& estimator : estimators_) {
      for (const NamedPath& path : paths_) {
        for (const NamedRole& role : roles()) {
          std::vector<std::string> cells = {escaped(estimator), path.title, role.name};
          bool any = false;
          for (const ProblemFacts& problem : experiment_.problems) {
            std::vector<double> numbers;
            std::vector<double> figures;
            for (const StrategyFacts& strategy : experiment_.strategies) {
              const double figure = compared(problem.name, strategy.name, path, role, estimator);
              const double number = samples(problem.name, strategy.name, path, role);
              if (std::isnan(figure) || std::isnan(number)) continue;
              numbers.push_back(number);
              figures.push_back(figure);
            }
            const double rho = rank_correlation(numbers, figures);
            any = any || !std::isnan(rho);
            cells.push_back(std::isnan(rho) ? "NA" : fmt::format("{} ({})", fixed(rho), figures.size()));
          }
          if (any) rows.push_back(std::move(cells));
        }
      }
    }
    if (rows.empty()) return;
    page_.heading("Rank correlation with the number of samples");
    page_.paragraph(
        "Spearman's, between each estimator's figures and N, per problem, over the strategies that have both (their "
        "number in brackets). An efficiency is to show where samples lie, not how many there are: near -1 a figure "
        "says little more than the sample count.");
    std::vector<std::string> header = {"estimator", "path", "samples"};
    for (const ProblemFacts& problem : experiment_.problems) header.push_back(escaped(problem.name));
    page_.header(header);
    for (const auto& cells : rows) page_.row(cells);
    page_.text() += '\n';
  }

  const ExperimentFacts& experiment_;
  std::vector<std::string> estimators_;
  std::map<std::pair<std::string, std::string>, const RunsSummary*> summaries_;  // by problem and strategy
  std::vector<NamedPath> paths_;                                                 // those that the tables have
  Markdown page_;
};

}  // namespace

std::string report_markdown(const ExperimentFacts& experiment, const ExperimentSummary& summary) {
  return Tables(experiment, summary).markdown();
}

std::string report_csv(const ExperimentFacts& experiment, const ExperimentSummary& summary) {
  return Tables(experiment, summary).csv();
}

}  // namespace trellis
