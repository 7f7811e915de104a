// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/report/words.hpp>
#include <trellis/trial/matcher.hpp>
#include <trellis/trial/paired_runs.hpp>

namespace trellis::trial {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int decimals = 2;

/// "+1.73 nats above uniform on average of 30 runs, at least +1.61 with 95 % confidence".
std::string figure_text(const Interval& interval, double confidence) {
  if (interval.infinite > 0) {
    return fmt::format("infinite in {}, {} nats above uniform at the median", plural(interval.infinite, "run"),
                       interval_text(interval, decimals, true));
  }
  const std::string bound =
      std::isfinite(interval.lo)
          ? fmt::format(", at least {} with {:g} % confidence", fixed(interval.lo, decimals, true), 100.0 * confidence)
          : std::string(", too few to say how sure that is");
  return fmt::format("{} nats above uniform on average of {}{}", fixed(interval.value, decimals, true),
                     plural(interval.n, "run"), bound);
}

class HasEfficiency final : public Matcher {
 public:
  HasEfficiency(Level level, Criterion nats) : level_(std::move(level)), nats_(std::move(nats)) {
    if (nats_.quantity() != Quantity::none) {
      throw Error(fmt::format("has_efficiency: takes nats, as has_efficiency(\"root\", above(0.5)), got a number of {}",
                              to_string(nats_.quantity())));
    }
    if (nats_.kind() == Criterion::Kind::exactly) {
      throw Error("has_efficiency: an estimate is nothing exactly; give a bound, as above(0.5)");
    }
    // Earlier versions took divergences here, of which less is better: reject such a script instead of giving a wrong
    // verdict.
    if (nats_.from_above()) {
      throw Error(
          "has_efficiency: the efficiency is in nats above uniform, of which more is better; give the least of it, as "
          "above(0.5), or above(TRIAL)");
    }
  }

  [[nodiscard]] bool of_efficiency() const override { return true; }

  [[nodiscard]] std::string text() const override {
    std::string which = level_.is_expansion() ? "expansion" : "";
    if (level_.is_lifted()) which += which.empty() ? "lifted" : ", lifted";
    const std::string what =
        fmt::format("has at {}{} an efficiency ", level_.name() == "root" ? "the root" : "level " + level_.name(),
                    which.empty() ? "" : fmt::format(" ({})", which));
    if (!nats_.other()) return fmt::format("{}{} nats", what, nats_.text());
    return fmt::format("{}{}above that of {}", what,
                       nats_.margin() > 0.0 ? fmt::format("{:g} nats ", nats_.margin()) : "", nats_.other()->name());
  }

  [[nodiscard]] Verdict judge(const Trial& trial) const override {
    const auto& runs = trial.scored_runs();
    const FigureOf figure = figure_of(runs);
    // A one-sided claim assigns the whole error probability to that side.
    const double two_sided = 2.0 * nats_.confidence() - 1.0;
    Verdict verdict;
    if (nats_.other()) {
      const auto& others = nats_.other()->scored_runs();
      const FigureOf theirs = figure_of(others);
      static_cast<void>(pairs_of(runs, trial, others, *nats_.other()));
      const std::vector<double> here = values_of(runs, figure);
      const std::vector<double> there = values_of(others, theirs);
      const Interval difference = paired(there, here, two_sided).difference;
      verdict.holds = difference.infinite == 0 && difference.lo > nats_.margin();
      verdict.finding = "a difference of " + figure_text(difference, nats_.confidence());
      if (difference.n == 0 && difference.infinite == 0) verdict.finding = "no seed has both figures";
      std::vector<double> worse(runs.size(), nan);
      for (std::size_t i = 0; i < runs.size(); ++i) worse[i] = here[i] - there[i];
      if (!verdict.holds) point_at_worst(verdict, runs, worse, "{} nats against the other's");
      return verdict;
    }
    const std::vector<double> values = values_of(runs, figure);
    const Interval mean = student_interval(values, two_sided);
    verdict.holds = mean.infinite == 0 && std::isfinite(mean.lo) && nats_.met_by(mean.lo);
    verdict.finding = figure_text(mean, nats_.confidence());
    const std::size_t scored = mean.n + mean.infinite;
    if (scored == 0) verdict.finding = "no run was scored: " + reason(runs);
    if (scored > 0 && scored < runs.size()) {
      verdict.finding += fmt::format("; {} without a figure", plural(runs.size() - scored, "run"));
    }
    if (!verdict.holds) point_at_worst(verdict, runs, values, "{} nats");
    return verdict;
  }

 private:
  [[nodiscard]] const Efficiency* find(const RunResult& run, const std::string& key) const {
    for (const LevelResult& level : run.levels) {
      if (level.record.key != key) continue;
      const auto& scores = level_.is_lifted() ? level.root : level.own;
      if (!scores) return nullptr;
      return level_.is_expansion() ? &scores->expansion : &scores->tree;
    }
    return nullptr;
  }

  [[nodiscard]] FigureOf figure_of(const std::vector<RunResult>& runs) const {
    return [this, key = find_level(runs, level_.name())](const RunResult& run) {
      const Efficiency* found = find(run, key);
      // An estimate beyond the possible range supports no claim.
      return found != nullptr ? shown(*found).gain : nan;
    };
  }

  static std::vector<double> values_of(const std::vector<RunResult>& runs, const FigureOf& figure) {
    std::vector<double> values;
    values.reserve(runs.size());
    for (const RunResult& run : runs) values.push_back(figure(run));
    return values;
  }

  /// Returns why no run has a value, if a run gives a reason.
  [[nodiscard]] std::string reason(const std::vector<RunResult>& runs) const {
    const std::string key = find_level(runs, level_.name());
    for (const RunResult& run : runs) {
      const Efficiency* found = find(run, key);
      if (found != nullptr && !found->reason.empty()) return found->reason;
    }
    const bool solved = std::any_of(runs.begin(), runs.end(), [](const RunResult& run) { return run.run.solved; });
    return solved ? "the level has no path of its own, or no samples" : "no run found a path";
  }

  void point_at_worst(Verdict& verdict, const std::vector<RunResult>& runs, const std::vector<double>& values,
                      const char* what) const {
    std::size_t worst = runs.size();
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (std::isnan(values[i])) continue;
      const bool worse = worst == runs.size() || values[i] < values[worst];
      if (worse) worst = i;
    }
    if (worst == runs.size()) {
      verdict.worst = runs.front().seed;
      verdict.why_worst = "has no figure";
      return;
    }
    verdict.worst = runs[worst].seed;
    verdict.why_worst = fmt::format(fmt::runtime(what), fixed(values[worst], decimals, true));
  }

  Level level_;
  Criterion nats_;
};

}  // namespace

MatcherPointer has_efficiency(Level level, Criterion nats) {
  return std::make_shared<HasEfficiency>(std::move(level), std::move(nats));
}

}  // namespace trellis::trial
