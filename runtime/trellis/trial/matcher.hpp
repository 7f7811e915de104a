// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <trellis/trial/criterion.hpp>
#include <trellis/trial/level.hpp>
#include <trellis/trial/trial.hpp>

namespace trellis::trial {

/// What came out when a trial was held against a matcher.
struct Verdict {
  bool holds = false;
  std::string finding;                      ///< in figures: "28 of 30 (93 %)"
  std::optional<std::uint64_t> worst = {};  ///< of what does not hold: the seed whose run tells most about it
  std::string why_worst = {};               ///< what that run did: "found no path (budget spent)"
};

/// What a trial is expected to do. Immutable.
class Matcher {
 public:
  Matcher() = default;
  Matcher(const Matcher&) = delete;
  Matcher& operator=(const Matcher&) = delete;
  virtual ~Matcher() = default;

  /// What it expects, to follow a strategy's name: "spends fewer validity checks than planner".
  [[nodiscard]] virtual std::string text() const = 0;
  /// Makes the trial's runs, where they are not there yet. Throws Error where the trial is none that it could hold for
  /// or not: another trial on other seeds, a level that there is not.
  [[nodiscard]] virtual Verdict judge(const Trial& trial) const = 0;
  /// Whether the samples' figures belong to what went wrong.
  [[nodiscard]] virtual bool of_efficiency() const { return false; }
};
using MatcherPointer = std::shared_ptr<const Matcher>;

// Each throws Error for a criterion that it cannot mean.

/// The share of the seeds whose run found a path. With a confidence it speaks of all seeds there are, by the end of
/// Wilson's interval; without, of those that were run.
MatcherPointer solves(Criterion share);

/// What runs spend until they have a path. It speaks of the median over all seeds there are: with the confidence at
/// least half of them spend so little (so much). A run without a path counts as if it spent more than any other where
/// less is claimed, as what it has spent where more is. Against another trial, the ratio of both seed by seed.
/// `exactly` is of each run that was made, whether it found a path or not.
MatcherPointer spends(Criterion spending);

/// All paths that were found lead from start to goal by valid motions and, with a criterion, are as long (m) as it says
/// at the median.
MatcherPointer finds_paths(std::optional<Criterion> length = {});

/// How many nats above uniform sampling a level samples, more is better, the mean over the runs that were scored: the
/// lower end of its interval, which Student's t gives for the confidence. Throws Error for a criterion that is no least
/// value (`above`, `at_least`), or that names a quantity.
MatcherPointer has_efficiency(Level level, Criterion nats);

/// The runs come out the same, to the last bit, when they are made again on one thread and on several.
MatcherPointer is_deterministic();

/// "guided spends fewer validity checks than planner: 0.31 times as many at the median ...".
std::string sentence(const Trial& trial, const Matcher& matcher, const Verdict& verdict);

/// What helps with a verdict that does not hold: the worst seed, what its levels did, and how to see it again. Lines,
/// each with a newline. `width` is that of the tables.
std::string evidence(const Trial& trial, const Matcher& matcher, const Verdict& verdict, int width = 120);

}  // namespace trellis::trial
