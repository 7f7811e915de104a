// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/words.hpp>
#include <trellis/trial/matcher.hpp>
#include <trellis/trial/paired_runs.hpp>

namespace trellis::trial {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int decimals = 2;
constexpr const char* root_key = "0";

/// "+1.73 nats of mass above uniform on average of 30 runs, at least +1.61 with 95 % confidence".
std::string figure_text(const Interval& interval, const char* what, double confidence) {
  if (interval.infinite > 0) {
    return fmt::format("infinite in {}, {} nats {} at the median", plural(interval.infinite, "run"),
                       interval_text(interval, decimals, true), what);
  }
  const std::string bound =
      std::isfinite(interval.lo)
          ? fmt::format(", at least {} with {:g} % confidence", fixed(interval.lo, decimals, true), 100.0 * confidence)
          : std::string(", too few to say how sure that is");
  return fmt::format("{} nats {} on average of {}{}", fixed(interval.value, decimals, true), what,
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
    if (!level_.is_mass() && nats_.confidence() > Criterion::default_confidence) {
      throw Error(
          fmt::format("has_efficiency: what samples support is known with {:g} % confidence, not {:g} %; mass takes "
                      "any confidence: "
                      "{{ part = \"mass\" }}, in C++ level(...).mass()",
                      100.0 * Criterion::default_confidence, 100.0 * nats_.confidence()));
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
        fmt::format("has at {}{} {} ", level_.name() == "root" ? "the root" : "level " + level_.name(),
                    which.empty() ? "" : fmt::format(" ({})", which), level_.is_mass() ? "a mass" : "an efficiency");
    if (!nats_.other()) return fmt::format("{}{} nats", what, nats_.text());
    return fmt::format("{}{}above that of {}", what,
                       nats_.margin() > 0.0 ? fmt::format("{:g} nats ", nats_.margin()) : "", nats_.other()->name());
  }

  [[nodiscard]] Verdict judge(const Trial& trial) const override {
    if (!level_.is_mass()) {
      const auto here = together(trial);
      if (!nats_.other()) {
        if (here) return judge_together(trial, *here, {}, "");
      } else if (const auto there = together(*nats_.other()); here && there) {
        static_cast<void>(pairs_of(trial.runs(), trial, nats_.other()->runs(), *nats_.other()));
        return judge_together(trial, *here, *there, nats_.other()->name());
      }
    }
    return judge_runs(trial);
  }

 private:
  // All seeds together -----------------------------------------------------------------------------------------------

  /// Returns what the samples of all seeds together support; none where they are not taken together.
  [[nodiscard]] std::optional<AboveUniform> together(const Trial& trial) const {
    const std::string key = find_level(trial.runs(), level_.name());
    if (key != root_key && !level_.is_lifted()) return {};
    for (const PooledScores& one : trial.pooled_scores()) {
      if (one.key != key) continue;
      AboveUniform above = trellis::above_uniform(level_.is_expansion() ? one.scores.expansion : one.scores.tree);
      if (std::isfinite(above.lo)) return above;
    }
    return {};
  }

  /// \param there  of the trial called `other`; unused for "" of none
  [[nodiscard]] Verdict judge_together(const Trial& trial, const AboveUniform& here, const AboveUniform& there,
                                       const std::string& other) const {
    Verdict verdict;
    const std::string samples = fmt::format("the samples of all {} together are", plural(trial.runs().size(), "seed"));
    const auto range = [](const AboveUniform& above) {
      const std::string lo = fixed(above.lo, decimals, true);
      const std::string hi = fixed(above.hi, decimals, true);
      return lo == hi ? lo : fmt::format("{} to {}", lo, hi);
    };
    if (other.empty()) {
      verdict.holds = nats_.met_by(here.lo);
      verdict.finding = fmt::format("{} {} nats above uniform", samples, range(here));
    } else {
      verdict.holds = here.lo - there.hi > nats_.margin();
      verdict.finding =
          fmt::format("{} {} nats above uniform, those of {} {}", samples, range(here), other, range(there));
    }
    if (verdict.holds) return verdict;
    if (!here.blank.empty())
      verdict.finding += ": so few samples do not show on which side of uniform sampling they are";
    if (other.empty()) verdict.finding += mass_text(trial.scored_runs());
    point_at_worst(verdict, trial.scored_runs(), values_of(trial.scored_runs(), estimate_of(trial.scored_runs())),
                   "{} nats, as estimated from its own samples");
    return verdict;
  }

  /// Says that the samples lie in the target but do not fill it, where that is what fails.
  [[nodiscard]] std::string mass_text(const std::vector<RunResult>& runs) const {
    const std::string key = find_level(runs, level_.name());
    const auto mass = [&](const RunResult& run) {
      const Efficiency* found = find(run, key);
      return found != nullptr ? found->uniform - shown(*found).parts.mass : nan;
    };
    const double mean = student_interval(values_of(runs, mass)).value;
    if (!std::isfinite(mean) || !nats_.met_by(mean)) return "";
    return fmt::format("; they lie in the target, {} nats of mass, but do not fill it ({{ part = \"mass\" }})",
                       fixed(mean, decimals, true));
  }

  // Run by run -------------------------------------------------------------------------------------------------------

  [[nodiscard]] Verdict judge_runs(const Trial& trial) const {
    const auto& runs = trial.scored_runs();
    // A one-sided claim assigns the whole error probability to that side.
    const double two_sided = 2.0 * nats_.confidence() - 1.0;
    const std::vector<double> here = values_of(runs, figure_of(runs, false));
    Verdict verdict;
    if (nats_.other()) {
      const auto& others = nats_.other()->scored_runs();
      static_cast<void>(pairs_of(runs, trial, others, *nats_.other()));
      const std::vector<double> there = values_of(others, figure_of(others, true));
      const Interval difference = paired(there, here, two_sided).difference;
      verdict.holds = difference.infinite == 0 && difference.lo > nats_.margin();
      verdict.finding = "a difference of " + figure_text(difference, what(), nats_.confidence());
      if (difference.n == 0 && difference.infinite == 0) verdict.finding = "no seed has both figures";
      std::vector<double> worse(runs.size(), nan);
      for (std::size_t i = 0; i < runs.size(); ++i) worse[i] = here[i] - there[i];
      if (!verdict.holds) point_at_worst(verdict, runs, worse, "{} nats against the other's");
      return verdict;
    }
    const Interval mean = student_interval(here, two_sided);
    verdict.holds = mean.infinite == 0 && std::isfinite(mean.lo) && nats_.met_by(mean.lo);
    verdict.finding = figure_text(mean, what(), nats_.confidence());
    const std::size_t scored = mean.n + mean.infinite;
    if (scored == 0) verdict.finding = "no run was scored: " + reason(runs);
    if (scored > 0 && scored < runs.size()) {
      verdict.finding += fmt::format("; {} without a figure", plural(runs.size() - scored, "run"));
    }
    if (!verdict.holds) point_at_worst(verdict, runs, here, "{} nats");
    return verdict;
  }

  /// What a run's figure is.
  [[nodiscard]] const char* what() const {
    return level_.is_mass() ? "of mass above uniform" : "above uniform, as far as its samples show,";
  }

  [[nodiscard]] const Efficiency* find(const RunResult& run, const std::string& key) const {
    for (const LevelResult& level : run.levels) {
      if (level.record.key != key) continue;
      const auto& scores = level_.is_lifted() ? level.root : level.own;
      if (!scores) return nullptr;
      return level_.is_expansion() ? &scores->expansion : &scores->tree;
    }
    return nullptr;
  }

  /// \param upper  whether what the samples support ends there, else begins; of mass there is one figure
  [[nodiscard]] FigureOf figure_of(const std::vector<RunResult>& runs, bool upper) const {
    return [this, upper, key = find_level(runs, level_.name())](const RunResult& run) {
      const Efficiency* found = find(run, key);
      if (found == nullptr) return nan;
      if (level_.is_mass()) return found->uniform - shown(*found).parts.mass;
      const AboveUniform above = trellis::above_uniform(*found);
      return upper ? above.hi : above.lo;
    };
  }
  /// The estimate distinguishes the runs; the interval of all seeds together judges it.
  [[nodiscard]] FigureOf estimate_of(const std::vector<RunResult>& runs) const {
    return [this, key = find_level(runs, level_.name())](const RunResult& run) {
      const Efficiency* found = find(run, key);
      return found != nullptr ? shown(*found).above_uniform : nan;
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
