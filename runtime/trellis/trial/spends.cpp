// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/report/words.hpp>
#include <trellis/trial/matcher.hpp>
#include <trellis/trial/paired_runs.hpp>

namespace trellis::trial {

namespace {

double spent(const LevelRecord& level, Quantity quantity) {
  switch (quantity) {
    case Quantity::validity_checks: return static_cast<double>(level.search.checks.validity);
    case Quantity::motion_checks: return static_cast<double>(level.search.checks.motion);
    case Quantity::proposals: return static_cast<double>(level.search.proposals.size());
    case Quantity::nodes: return static_cast<double>(level.search.nodes.size());
    case Quantity::none: break;
  }
  throw Fault("spends: no quantity");
}

/// Returns the cost of a run in the level of a key, or, with "", of all levels. A level that the run never reached
/// costs 0.
double spent(const RunResult& run, Quantity quantity, const std::string& key) {
  if (key.empty() && quantity == Quantity::validity_checks) return static_cast<double>(run.run.validity_checks);
  if (key.empty() && quantity == Quantity::motion_checks) return static_cast<double>(run.run.motion_checks);
  double sum = 0.0;
  for (const LevelResult& level : run.levels) {
    if (key.empty() || level.record.key == key) sum += spent(level.record, quantity);
  }
  return sum;
}

class Spends final : public Matcher {
 public:
  explicit Spends(Criterion criterion) : criterion_(std::move(criterion)) {
    if (criterion_.quantity() == Quantity::none) {
      throw Error(
          fmt::format("spends: of what? Write one of .validity_checks(), .motion_checks(), .proposals(), "
                      ".nodes() behind '{}'",
                      criterion_.text()));
    }
    if (!criterion_.other() && criterion_.value() < 0.0) {
      throw Error(fmt::format("spends: expected a number of at least 0, got {:g}", criterion_.value()));
    }
    if (criterion_.from_above() && criterion_.margin() >= 1.0) {
      throw Error(
          fmt::format("spends: by(x) is a share of the other's spending, less than 1, got {:g}", criterion_.margin()));
    }
  }

  [[nodiscard]] std::string text() const override {
    const auto noun = to_string(criterion_.quantity());
    const std::string where =
        criterion_.level().empty() ? std::string() : fmt::format(" in level {}", criterion_.level());
    if (!criterion_.other()) return fmt::format("spends {} {}{}", criterion_.text(), noun, where);
    return fmt::format("spends {}{} {}{} than {}",
                       criterion_.margin() > 0.0 ? fmt::format("{:g} % ", 100.0 * criterion_.margin()) : "",
                       criterion_.from_above() ? "fewer" : "more", noun, where, criterion_.other()->name());
  }

  [[nodiscard]] Verdict judge(const Trial& trial) const override {
    const auto& runs = trial.runs();
    const MedianWords words{"spent", std::string(to_string(criterion_.quantity()))};
    const FigureOf figure = figure_of(runs);
    if (criterion_.other()) {
      const auto& others = criterion_.other()->runs();
      return judge_ratio(criterion_, pairs_of(runs, trial, others, *criterion_.other()), figure, figure_of(others),
                         words);
    }
    if (criterion_.kind() == Criterion::Kind::exactly) return judge_each(runs, figure, words);
    return judge_median(criterion_, runs, figure, words);
  }

 private:
  [[nodiscard]] FigureOf figure_of(const std::vector<RunResult>& runs) const {
    const std::string key = criterion_.level().empty() ? "" : find_level(runs, criterion_.level());
    return [quantity = criterion_.quantity(), key](const RunResult& run) { return spent(run, quantity, key); };
  }

  [[nodiscard]] Verdict judge_each(const std::vector<RunResult>& runs, const FigureOf& figure,
                                   const MedianWords& words) const {
    Verdict verdict;
    verdict.holds = true;
    double lo = std::numeric_limits<double>::infinity();
    double hi = 0.0;
    for (const RunResult& run : runs) {
      const double value = figure(run);
      lo = std::min(lo, value);
      hi = std::max(hi, value);
      if (criterion_.met_by(value) || !verdict.holds) continue;
      verdict.holds = false;
      verdict.worst = run.seed;
      verdict.why_worst = fmt::format("spent {:g} {}", value, words.noun);
    }
    verdict.finding = lo == hi ? fmt::format("{:g} in each of {}", lo, plural(runs.size(), "run"))
                               : fmt::format("from {:g} to {:g} in {}", lo, hi, plural(runs.size(), "run"));
    return verdict;
  }

  Criterion criterion_;
};

}  // namespace

MatcherPointer spends(Criterion spending) { return std::make_shared<Spends>(std::move(spending)); }

}  // namespace trellis::trial
