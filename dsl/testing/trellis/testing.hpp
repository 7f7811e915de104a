// SPDX-License-Identifier: GPL-3.0-or-later
// Scenario tests of strategies, in Catch2 (version 2 or 3). See docs/testing.md.
//
//     const Script script = load("doorway.lua");
//     const Trial guided = script.trial("guided", seeds(30));
//     const Trial planner = script.trial("planner", seeds(30));
//     CHECK_THAT(guided, Solves(at_least(0.95)));
//     CHECK_THAT(guided, Spends(below(planner).validity_checks()));
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_tostring.hpp>
#include <catch2/matchers/catch_matchers.hpp>
#else
#include <catch2/catch.hpp>
#endif

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/trial/criterion.hpp>
#include <trellis/trial/level.hpp>
#include <trellis/trial/matcher.hpp>
#include <trellis/trial/trial.hpp>

namespace trellis::testing {

using trial::above;
using trial::at_least;
using trial::at_most;
using trial::below;
using trial::exactly;
using trial::seeds;
using trial::Trial;

/// Selects a level by its name or number: level("lazy").expansion().lifted().
inline trial::Level level(std::string name) { return {std::move(name)}; }
inline trial::Level level(int number) { return {number}; }

/// The problems and strategies of a script's experiment. Copies share the script and its trials; only one thread may
/// use them at a time.
class Script {
 public:
  /// Returns a strategy of the experiment.
  /// \throws Error for an unknown name, with the nearest one
  [[nodiscard]] StrategySpec strategy(const std::string& name) const;
  /// Returns a problem of the experiment.
  /// \param name  "": the only problem
  /// \throws Error for an unknown name, and for "" where there are several problems
  [[nodiscard]] Problem problem(const std::string& name = "") const;
  /// The names of the problems of the experiment, in its order.
  [[nodiscard]] std::vector<std::string> problems() const;
  /// Returns the trial of a strategy on a problem. A repeated call returns the same trial, whose runs execute once:
  /// Catch2 runs a test case from its beginning for each of its sections. The runs are executed when a check first
  /// needs them, on all cores. \param seeds  each at most once \param problem  "": the only problem \throws Error for
  /// an unknown name, for seeds that repeat, and for an empty list of seeds
  [[nodiscard]] Trial trial(const std::string& strategy, std::vector<std::uint64_t> seeds = trial::seeds(30),
                            const std::string& problem = "") const;

 private:
  friend Script load(const std::string& path);
  struct State;
  explicit Script(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

/// Loads a script, once as long as its text does not change. Nothing is planned.
/// \param path  relative to the working directory of the test
/// \throws Error if the script cannot be read, fails, or returns no experiment
Script load(const std::string& path);

/// Returns the trial of a strategy that C++ code builds. Each call makes another trial, whose runs are executed anew.
/// \param name  of the strategy in messages; "": its text
/// \throws Error for seeds that repeat, and for an empty list of seeds
inline Trial trial(std::string name, StrategySpec strategy, Problem problem,
                   std::vector<std::uint64_t> on = trial::seeds(30)) {
  return Trial(trial::Setup{
      .name = std::move(name), .strategy = std::move(strategy), .problem = std::move(problem), .seeds = std::move(on)});
}

#if __has_include(<catch2/catch_all.hpp>)
using CatchMatcher = Catch::Matchers::MatcherBase<Trial>;
#else
using CatchMatcher = Catch::MatcherBase<Trial>;
#endif

/// Adapts a matcher to Catch2. Its description of a judged trial is the finding; for a failed one it adds the evidence:
/// a seed, its levels, and how to reproduce the run.
class Matches final : public CatchMatcher {
 public:
  explicit Matches(trial::MatcherPointer matcher) : matcher_(std::move(matcher)) {}

  bool match(const Trial& trial) const override {
    const trial::Verdict verdict = matcher_->judge(trial);
    said_ = matcher_->text() + ": " + verdict.finding;
    if (verdict.holds) return true;
    said_ += '\n';
    said_ += trial::evidence(trial, *matcher_, verdict);
    return false;
  }
  [[nodiscard]] std::string describe() const override { return said_.empty() ? matcher_->text() : said_; }

 private:
  trial::MatcherPointer matcher_;
  mutable std::string said_;
};

// trial/matcher.hpp says what each of them means, in which units, and which criteria it takes. They throw Error for any
// other criterion. NOLINTBEGIN(readability-identifier-naming): matchers of Catch2's are
// called so.
inline Matches Solves(trial::Criterion share) { return Matches(trial::solves(std::move(share))); }
inline Matches Spends(trial::Criterion spending) { return Matches(trial::spends(std::move(spending))); }
inline Matches FindsPaths() { return Matches(trial::finds_paths()); }
inline Matches FindsPaths(trial::Criterion length) { return Matches(trial::finds_paths(std::move(length))); }
inline Matches HasEfficiency(trial::Level level, trial::Criterion nats) {
  return Matches(trial::has_efficiency(std::move(level), std::move(nats)));
}
inline Matches IsDeterministic() { return Matches(trial::is_deterministic()); }
// NOLINTEND(readability-identifier-naming)

}  // namespace trellis::testing

namespace Catch {
template <>
struct StringMaker<trellis::trial::Trial> {
  static std::string convert(const trellis::trial::Trial& trial) { return trial.text(); }
};
}  // namespace Catch
