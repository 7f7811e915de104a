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
struct RunResult;
}  // namespace trellis

namespace trellis::trial {

/// How many seeds a trial has unless somebody says otherwise.
inline constexpr std::uint64_t default_seeds = 30;

/// The largest number of seeds that anybody may ask for: more is a slip of the pen.
inline constexpr std::uint64_t most_seeds = 1'000'000;

/// `count` consecutive seeds from `first`. Throws Error for none, too many, or seeds that a script cannot write (over
/// 2^63 - 1).
std::vector<std::uint64_t> seeds(std::uint64_t count, std::uint64_t first = 1);

/// What a trial is made from.
struct Setup {
  std::string name;  ///< of the strategy; "": its text
  StrategySpec strategy;
  Problem problem;
  std::vector<std::uint64_t> seeds = trial::seeds(default_seeds);
  /// How samples are scored, each run on its own path; none: against tube {}.
  std::shared_ptr<const Measure> measure = {};
  std::int64_t shortcut = 0;  ///< rounds of shortcutting on each found path
  /// The script whose experiment has the strategy and the problem under their names, "" where they were built in code.
  std::string script = {};
};

/// How the runs of a trial are made. Their results do not depend on it.
struct Making {
  unsigned jobs = 0;  ///< runs at the same time; 0: as many as the machine has cores
  /// Asked between proposals, from all threads; true ends the trial (Interrupted).
  std::function<bool()> interrupted = {};
};

/// A strategy on a problem over a range of seeds. Nothing runs before somebody asks, and then once, however many copies
/// of the trial there are: they share the runs. One thread at a time.
class Trial {
 public:
  /// Throws Error for seeds that repeat or are missing.
  explicit Trial(Setup setup, Making making = {});

  [[nodiscard]] const Setup& setup() const;
  [[nodiscard]] const std::string& name() const { return setup().name; }
  /// "guided on doorway, 30 seeds (1–30)".
  [[nodiscard]] std::string text() const;

  /// The runs in the order of the seeds, made where they are not yet. Throws Error for a problem that cannot be
  /// planned, and Interrupted.
  [[nodiscard]] const std::vector<RunResult>& runs() const;
  /// The same, scored too.
  [[nodiscard]] const std::vector<RunResult>& scored_runs() const;
  /// Made anew, on so many threads; kept by nobody.
  [[nodiscard]] std::vector<RunResult> runs_again(unsigned jobs) const;

  /// Lets go of the runs, which may take much; who asks again has them made again.
  void forget() const;

  /// How to see one of its runs again: a command where the script is known, else what to type in a session.
  [[nodiscard]] std::string replay(std::uint64_t seed) const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace trellis::trial
