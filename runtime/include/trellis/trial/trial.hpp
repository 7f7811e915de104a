// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <trellis/scene/scene.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {
struct Measure;
struct PooledScores;
struct RunResult;
}  // namespace trellis

namespace trellis::trial {

/// The default number of seeds of a trial.
inline constexpr std::uint64_t default_seeds = 30;

/// The largest number of seeds of a trial: a larger number is a typing error.
inline constexpr std::uint64_t most_seeds = 1'000'000;

/// Returns `count` consecutive seeds from `first`.
/// \param count  from 1 to `most_seeds`
/// \param first  at most 2^63 - `count`
/// \throws Error for another count, or for seeds that a script cannot write (over 2^63 - 1)
std::vector<std::uint64_t> seeds(std::uint64_t count, std::uint64_t first = 1);

/// The strategy, problem, seeds and options of a trial.
struct Setup {
  std::string name;  ///< of the strategy; "": its text
  StrategySpec strategy;
  Problem problem;
  std::vector<std::uint64_t> seeds = trial::seeds(default_seeds);
  /// The measure of the samples, relative to each run's own path; none: tube {}.
  std::shared_ptr<const Measure> measure = {};
  std::int64_t shortcut = 0;  ///< rounds of shortcutting on each found path
  /// The script whose experiment defines the strategy and the problem under their names; "" where code builds them.
  std::string script = {};
};

/// How to execute the runs of a trial. Results do not depend on it.
struct Making {
  unsigned jobs = 0;  ///< concurrent runs; 0: as many as the machine has cores
  /// Called between proposals, from all threads; true stops the trial (Interrupted).
  std::function<bool()> interrupted = {};
};

/// A strategy on a problem over a range of seeds. Runs start on the first request for results and execute once: all
/// copies of the trial share them. Only one thread may use it at a time.
class Trial {
 public:
  /// \param setup  with a problem that has a scene; the problem is checked by the first request for results
  /// \param making  copied; what its function refers to outlives the trial
  /// \throws Error for seeds that repeat or are missing.
  explicit Trial(Setup setup, Making making = {});

  [[nodiscard]] const Setup& setup() const;
  [[nodiscard]] const std::string& name() const { return setup().name; }
  /// "guided on doorway, 30 seeds (1–30)".
  [[nodiscard]] std::string text() const;

  /// Returns the runs in the order of the seeds; executes them first where necessary.
  /// \return valid until forget()
  /// \throws Error for an invalid problem, and Interrupted.
  [[nodiscard]] const std::vector<RunResult>& runs() const;
  /// As runs(), and scores their samples, which takes several times as long.
  /// \throws Error for an invalid problem, and Interrupted
  [[nodiscard]] const std::vector<RunResult>& scored_runs() const;
  /// Scores the samples of all seeds but one taken together, of each level, lifted to the root, on paths of the seed
  /// left out. None with fewer than five seeds, without paths, and for a target that is not made from a path.
  /// \throws Error for an invalid problem, and Interrupted
  [[nodiscard]] const std::vector<PooledScores>& pooled_scores() const;
  /// Executes the runs again, `jobs` at the same time, with two threads each if these are several; does not store them.
  /// \param jobs  0: as many as the machine has cores
  /// \throws Error for an invalid problem, and Interrupted
  [[nodiscard]] std::vector<RunResult> runs_again(unsigned jobs) const;

  /// Releases the memory of the runs; the next request executes them again.
  void forget() const;

  /// Returns how to reproduce one of its runs: a command where the script is available, else statements for a session.
  /// \param seed  one of the trial's, which is not checked
  [[nodiscard]] std::string replay(std::uint64_t seed) const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace trellis::trial
