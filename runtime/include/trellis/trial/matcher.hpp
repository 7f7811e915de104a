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

/// The result of checking a trial with a matcher.
struct Verdict {
  bool holds = false;
  std::string finding;                      ///< the statistic: "28 of 30 (93 %)"
  std::optional<std::uint64_t> worst = {};  ///< of a failed check: the seed of the run that shows the failure best
  std::string why_worst = {};               ///< the outcome of that run: "found no path (budget spent)"
};

/// A check on the results of a trial. Immutable.
class Matcher {
 public:
  Matcher() = default;
  Matcher(const Matcher&) = delete;
  Matcher& operator=(const Matcher&) = delete;
  virtual ~Matcher() = default;

  /// Returns the expectation, to follow a strategy's name: "spends fewer validity checks than planner".
  [[nodiscard]] virtual std::string text() const = 0;
  /// Checks the trial; runs it first where that has not happened.
  /// \param trial  whose runs and scores may be executed here
  /// \throws Error where the check does not apply to the trial: another trial on other seeds, an unknown level.
  [[nodiscard]] virtual Verdict judge(const Trial& trial) const = 0;
  /// Whether the evidence of a failure includes the sample statistics.
  [[nodiscard]] virtual bool of_efficiency() const { return false; }
};
using MatcherPointer = std::shared_ptr<const Matcher>;

// Each throws Error for a criterion that does not apply to it, as a number out of range. Matchers may be shared between
// threads; their trials may not.

/// Checks the share of the seeds whose run found a path. With a confidence the check is about all possible seeds, by
/// the bound of Wilson's interval; without, about the seeds of the trial.
/// \param share  in [0, 1]
MatcherPointer solves(Criterion share);

/// Checks the cost of runs until they have a path. The check is about the median over all possible seeds: with the
/// confidence, at least half of them have at most (at least) this cost. A run without a path counts as more expensive
/// than all others where the claim is "less", and with its actual cost where the claim is "more". Against another
/// trial, checks the ratio of both, paired by seed. `exactly` applies to each run of the trial, whether it found a path
/// or not.
/// \param spending  with a quantity (Criterion::validity_checks and its like); a number of these, or another trial
MatcherPointer spends(Criterion spending);

/// Checks that all found paths lead from start to goal by valid motions, and their median length.
/// \param length  in metres of the metric, `at_most` and its like; none: any length
MatcherPointer finds_paths(std::optional<Criterion> length = {});

/// Checks by how many nats the samples of a level exceed uniform sampling (more is better): what the samples support
/// (`measure::supported_interval`, 95 %), so thin guidance is never taken for good guidance. Of the root and of lifted
/// levels, with five seeds or more, the samples of all seeds are taken together; else the lower ends of the runs'
/// intervals count, by the lower bound of Student's interval of their mean. Another trial is exceeded where the two
/// intervals do. Of mass alone: by the lower bound of Student's interval of the runs' masses.
/// \param level  which samples, and in which space
/// \param nats  above uniform sampling
/// \throws Error for a criterion that is not a lower bound (`above`, `at_least`), that names a quantity, or whose
/// confidence is above 95 % where what samples support is judged.
MatcherPointer has_efficiency(Level level, Criterion nats);

/// Checks that runs that are executed again, on one thread and on several, give the same results, bit for bit.
MatcherPointer is_deterministic();

/// Returns the verdict in a sentence: "guided spends fewer validity checks than planner: 0.31 times as many at the
/// median ...".
/// \param trial  the trial that the matcher checked
/// \param matcher  made the verdict
/// \param verdict  its `finding` ends the sentence
std::string sentence(const Trial& trial, const Matcher& matcher, const Verdict& verdict);

/// Returns evidence on a failed check: the worst seed, the statistics of its levels, and how to reproduce the run.
/// Lines, each with a newline.
/// \param trial  the trial that the matcher checked; its runs are executed again where they were released
/// \param matcher  made the verdict
/// \param verdict  without `worst` there is no evidence: ""
/// \param width  of the tables, in columns
std::string evidence(const Trial& trial, const Matcher& matcher, const Verdict& verdict, int width = 120);

}  // namespace trellis::trial
