// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/trial/trial.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <set>
#include <string_view>
#include <thread>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/parallel.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/experiment/scoring.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/report/words.hpp>

namespace trellis::trial {

namespace {

/// Quotes a word for a shell where necessary.
std::string shell_word(const std::string& word) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./=@:,%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string(R"('\'')") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::vector<std::uint64_t> seeds(std::uint64_t count, std::uint64_t first) {
  constexpr auto largest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (count == 0 || count > most_seeds) {
    throw Error(fmt::format("the number of seeds must be an integer in [1, {}], got {}", most_seeds, count));
  }
  if (first > largest - (count - 1)) {
    throw Error(fmt::format("{} consecutive seeds from {} go beyond the largest one, {}", count, first, largest));
  }
  std::vector<std::uint64_t> list(count);
  std::iota(list.begin(), list.end(), first);
  return list;
}

struct Trial::State {
  Setup setup;
  Making making;
  std::vector<RunResult> runs = {};
  std::vector<PooledScores> pooled = {};
  bool made = false;
  bool scored = false;
  bool has_pooled = false;

  /// \param cross  on how many paths of other seeds each run is scored
  [[nodiscard]] Experiment experiment(std::int64_t cross = 0) const {
    Experiment one;
    one.problems = {setup.problem};
    one.strategies = {{setup.name, setup.strategy}};
    one.seeds = setup.seeds;
    one.shortcut = setup.shortcut;
    if (setup.measure) one.measure = *setup.measure;
    one.measure->cross = cross;
    return one;
  }

  [[nodiscard]] std::vector<RunResult> make(unsigned jobs, unsigned threads = 1) const {
    check(experiment());
    std::vector<RunResult> made_now(setup.seeds.size());
    std::atomic<bool> stop{false};  // an exception in one run stops the others
    const std::function<bool()> interrupted = [&] {
      return stop.load(std::memory_order_relaxed) || (making.interrupted && making.interrupted());
    };
    in_parallel(made_now.size(), jobs, [&](std::size_t i) {
      try {
        if (interrupted()) throw Interrupted();
        RunResult run = run_cell(setup.name, setup.strategy, setup.problem, setup.seeds[i],
                                 {.shortcut = setup.shortcut, .interrupted = interrupted, .threads = threads});
        if (run.run.status == Status::interrupted) throw Interrupted();
        if (i == 0) check_unused_guides(setup.strategy, setup.problem, run.run);
        made_now[i] = std::move(run);
      } catch (...) {
        stop.store(true);
        throw;
      }
    });
    return made_now;
  }

  /// Scores the runs, which are then released.
  void score(ExperimentResult& result, const Experiment& of, ScoreScope scope) const {
    const std::function<bool()> never = [] { return false; };
    trellis::score(
        of, result, jobs(), [] {}, making.interrupted ? making.interrupted : never, scope);
    for (RunResult& run : result.runs) release(run);
  }

  [[nodiscard]] unsigned jobs() const {
    return making.jobs > 0 ? making.jobs : std::max(1U, std::thread::hardware_concurrency());
  }
};

Trial::Trial(Setup setup, Making making) {
  if (setup.name.empty()) setup.name = setup.strategy.text();
  if (setup.seeds.empty()) throw Error(fmt::format("a trial of {}: no seed given", setup.name));
  if (std::set(setup.seeds.begin(), setup.seeds.end()).size() < setup.seeds.size()) {
    throw Error(fmt::format("a trial of {}: a seed is given twice", setup.name));
  }
  state_ = std::make_shared<State>(State{std::move(setup), std::move(making)});
}

const Setup& Trial::setup() const { return state_->setup; }

std::string Trial::text() const {
  return fmt::format("{} on {}, {}", setup().name, setup().problem.name, seeds_text(setup().seeds));
}

const std::vector<RunResult>& Trial::runs() const {
  if (!state_->made) {
    state_->runs = state_->make(state_->jobs());
    state_->made = true;
  }
  return state_->runs;
}

const std::vector<RunResult>& Trial::scored_runs() const {
  static_cast<void>(runs());
  if (state_->scored) return state_->runs;
  ExperimentResult result;
  result.runs = state_->runs;
  state_->score(result, state_->experiment(), ScoreScope::all);
  state_->runs = std::move(result.runs);
  state_->scored = true;
  return state_->runs;
}

const std::vector<PooledScores>& Trial::pooled_scores() const {
  if (state_->has_pooled) return state_->pooled;
  constexpr std::int64_t paths = 2;
  if (setup().seeds.size() >= least_for_interval) {
    ExperimentResult result;
    // Scored runs have released what scoring needs.
    result.runs = state_->scored ? state_->make(state_->jobs()) : runs();
    state_->score(result, state_->experiment(paths), ScoreScope::overview);
    state_->pooled = std::move(result.pooled);
  }
  state_->has_pooled = true;
  return state_->pooled;
}

std::vector<RunResult> Trial::runs_again(unsigned jobs) const { return state_->make(jobs, std::min(jobs, 2U)); }

void Trial::forget() const {
  state_->runs.clear();
  state_->pooled.clear();
  state_->made = false;
  state_->scored = false;
  state_->has_pooled = false;
}

std::string Trial::replay(std::uint64_t seed) const {
  if (!setup().script.empty()) {
    return fmt::format("trellis run {} --strategy {} --problem {} --only {}", shell_word(setup().script),
                       shell_word(setup().name), shell_word(setup().problem.name), seed);
  }
  return fmt::format("in trellis repl, with the problem '{}' as p: plan({}, p, {{ seed = {} }})", setup().problem.name,
                     setup().strategy.text(), seed);
}

}  // namespace trellis::trial
