// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/experiment.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <numeric>
#include <set>
#include <thread>

#include <trellis/base/error.hpp>
#include <trellis/base/parallel.hpp>
#include <trellis/base/random.hpp>
#include <trellis/experiment/baseline.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/input_warnings.hpp>
#include <trellis/experiment/left_out.hpp>
#include <trellis/experiment/partial.hpp>
#include <trellis/experiment/scoring.hpp>
#include <trellis/experiment/store.hpp>
#include <trellis/experiment/uncoupled_runs.hpp>
#include <trellis/measure/estimator.hpp>
#include <trellis/strategy/ablation.hpp>
#include <trellis/strategy/scale.hpp>

namespace trellis {

namespace {

constexpr std::size_t most_runs = 1'000'000;  // of one experiment

void check_name(const char* one, const char* many, const std::string& name, std::set<std::string>& taken) {
  if (name.empty()) throw Error(fmt::format("experiment: a {} without a name", one));
  if (!taken.insert(name).second) throw Error(fmt::format("experiment: two {} are called '{}'", many, name));
}

/// The ranges are those of the registry, so that C++ callers and scripts have the same checks.
void check(const Component& component, const std::vector<Options::Entry>& all) {
  std::vector<Options::Entry> given;
  std::copy_if(all.begin(), all.end(), std::back_inserter(given),
               [&](const Options::Entry& entry) { return component.find(entry.first) != nullptr; });
  static_cast<void>(Options::validate(component, given));
}

/// The options of a measure's target, of which its component has some.
struct TargetOptions {
  const Component* component = nullptr;
  std::vector<Options::Entry> entries;
};

TargetOptions options_of(const TargetSpec& target) {
  const TargetSettings& common = common_settings(target);
  std::vector<Options::Entry> all = {{"delta", common.delta}, {"points", common.points}, {"pool", common.pool}};
  const auto with = [&](const Component& component, std::vector<Options::Entry> own) -> TargetOptions {
    all.insert(all.end(), own.begin(), own.end());
    return {&component, all};
  };
  if (const auto* tube = std::get_if<TubeSettings>(&target)) {
    return with(tube_settings().component(),
                {{"distance", to_string(tube->distance)}, {"support", to_string(tube->support)}});
  }
  if (const auto* near = std::get_if<NearOptimalSettings>(&target)) {
    return with(near_optimal_settings().component(), {{"epsilon", near->epsilon}, {"nodes", near->nodes}});
  }
  if (const auto* progress = std::get_if<ProgressSettings>(&target)) {
    return with(progress_settings().component(), {{"step", progress->step}, {"controls", progress->controls}});
  }
  return {&tube_settings().component(), all};
}

/// Checks the scale of all options on all problems.
void check_scales(const Experiment& experiment) {
  for (const Problem& problem : experiment.problems) {
    for (const auto& [name, strategy] : experiment.strategies) check_scale(strategy, problem);
    if (!experiment.measure) continue;
    const TargetOptions target = options_of(experiment.measure->target);
    check_scale(*target.component, target.entries, problem);
    for (const EstimatorSpec& estimator : experiment.measure->estimators) {
      check_scale(*measure::find_estimator(estimator.name())->component, estimator.options().entries(), problem);
    }
  }
}

void check(const Measure& measure) {
  if (measure.cross < 0) throw Error(fmt::format("experiment: cross must be at least 0 paths, got {}", measure.cross));
  if (measure.estimators.empty()) throw Error("experiment: no estimator given");
  const TargetOptions target = options_of(measure.target);
  check(*target.component, target.entries);
  const auto* own = std::get_if<UserTarget>(&measure.target);
  if (own != nullptr && !own->make) throw Error("target: has no samples");
}

/// The index of a cell in the fixed order of the result: by problem, strategy, seed.
struct Cell {
  const Problem& problem;
  const std::pair<std::string, StrategySpec>& strategy;
  std::uint64_t seed;

  Cell(const Experiment& experiment, std::size_t index)
      : problem(experiment.problems[index / experiment.seeds.size() / experiment.strategies.size()]),
        strategy(experiment.strategies[index / experiment.seeds.size() % experiment.strategies.size()]),
        seed(experiment.seeds[index % experiment.seeds.size()]) {}
};

/// Returns the cells in the order of execution: by problem, then by seed, with the strategies of each seed shuffled.
std::vector<std::size_t> order_of_cells(const Experiment& experiment) {
  const std::size_t strategies = experiment.strategies.size();
  const std::size_t seeds = experiment.seeds.size();
  std::vector<std::size_t> order;
  order.reserve(experiment.problems.size() * strategies * seeds);
  std::vector<std::size_t> shuffled(strategies);
  for (std::size_t p = 0; p < experiment.problems.size(); ++p) {
    for (std::size_t s = 0; s < seeds; ++s) {
      std::iota(shuffled.begin(), shuffled.end(), std::size_t{0});
      Stream stream(experiment.seeds[s], experiment.problems[p].name, "order of strategies");
      for (std::size_t i = strategies; i > 1; --i) std::swap(shuffled[i - 1], shuffled[stream.below(i)]);
      for (const std::size_t k : shuffled) order.push_back((p * strategies + k) * seeds + s);
    }
  }
  return order;
}

}  // namespace

std::string target_text(const TargetSpec& target) {
  if (const auto* tube = std::get_if<TubeSettings>(&target)) {
    return fmt::format(
        "{} within {:g} m ({}) of the path",
        tube->support == TubeSettings::Support::free ? "valid configurations" : "configurations, valid or not,",
        tube->delta, tube->distance == TubeSettings::Distance::planar ? "position only, all headings" : "full metric");
  }
  if (const auto* near = std::get_if<NearOptimalSettings>(&target)) {
    return fmt::format("configurations on paths of at most {:g} times the optimal length", 1.0 + near->epsilon);
  }
  if (const auto* progress = std::get_if<ProgressSettings>(&target)) {
    return fmt::format(
        "motions that come closer to the goal, by rank among those that the planner could choose, straight ones of "
        "{:g} m",
        progress->step);
  }
  return "the script's own";
}

std::string target_name(const TargetSpec& target) {
  if (std::holds_alternative<TubeSettings>(target)) return tube_settings().component().name;
  if (std::holds_alternative<NearOptimalSettings>(target)) return near_optimal_settings().component().name;
  if (std::holds_alternative<ProgressSettings>(target)) return progress_settings().component().name;
  return "target";
}

const TargetSettings& common_settings(const TargetSpec& target) {
  return std::visit([](const TargetSettings& settings) -> const TargetSettings& { return settings; }, target);
}

std::size_t steps(const Experiment& experiment) {
  const std::size_t cells = experiment.problems.size() * experiment.strategies.size() * experiment.seeds.size();
  return experiment.measure ? 2 * cells : cells;
}

std::string baseline_of(const Experiment& experiment) {
  if (!experiment.baseline.empty()) return experiment.baseline;
  std::vector<const std::pair<std::string, StrategySpec>*> whole;
  for (const auto& entry : experiment.strategies) {
    const auto is_ablation = [&](const AblationLink& link) { return link.strategy == entry.first; };
    if (std::none_of(experiment.ablations.begin(), experiment.ablations.end(), is_ablation)) whole.push_back(&entry);
  }
  if (whole.size() < 2) return "";
  const auto plain =
      std::find_if(whole.begin(), whole.end(), [](const auto* entry) { return entry->second.guide() == nullptr; });
  return plain != whole.end() ? (*plain)->first : whole.front()->first;
}

void ablate(Experiment& experiment, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const auto& all = experiment.strategies;
    const auto it = std::find_if(all.begin(), all.end(), [&](const auto& entry) { return entry.first == name; });
    if (it == all.end()) {
      std::vector<std::string> known;
      known.reserve(all.size());
      for (const auto& entry : all) known.push_back(entry.first);
      throw Error(fmt::format("experiment: ablate names no strategy: '{}'{}", name, did_you_mean(name, known)));
    }
    const std::vector<Ablation> taken = ablations(it->second);
    if (taken.empty()) {
      throw Error(fmt::format("experiment: ablate: strategy '{}' has no guide that could be taken out", name));
    }
    for (const Ablation& ablation : taken) {
      const std::string text = fmt::format("{} {}", name, ablation.text());
      experiment.ablations.push_back({text, name, ablation.text(), ablation.key, ablation.skipped});
      experiment.strategies.emplace_back(text, ablation.strategy);
    }
  }
}

std::string unknown_baseline(const std::string& baseline, const std::vector<std::string>& strategies) {
  return fmt::format("experiment: baseline '{}' is no strategy{}; there are: {}", baseline,
                     did_you_mean(baseline, strategies), fmt::join(strategies, ", "));
}

void check(const Experiment& experiment) {
  if (experiment.problems.empty()) throw Error("experiment: no problem given");
  if (experiment.strategies.empty()) throw Error("experiment: no strategy given");
  if (experiment.seeds.empty()) throw Error("experiment: no seed given");
  if (!(experiment.ablation >= 0.0)) throw Error("experiment: ablation must be at least 0");
  if (experiment.shortcut < 0) {
    throw Error(fmt::format("experiment: shortcut must be at least 0 rounds, got {}", experiment.shortcut));
  }
  std::set<std::string> problems;
  for (const auto& problem : experiment.problems) check_name("problem", "problems", problem.name, problems);
  std::set<std::string> strategies;
  for (const auto& [name, spec] : experiment.strategies) check_name("strategy", "strategies", name, strategies);
  std::set<std::uint64_t> seeds;
  for (const auto seed : experiment.seeds) {
    if (!seeds.insert(seed).second) {
      throw Error(fmt::format("experiment: seed {} is given twice; the same run would be counted twice", seed));
    }
  }
  if (experiment.measure) check(*experiment.measure);
  if (!experiment.baseline.empty() && !strategies.contains(experiment.baseline)) {
    const std::vector<std::string> known(strategies.begin(), strategies.end());
    throw Error(unknown_baseline(experiment.baseline, known));
  }
  for (const auto& problem : experiment.problems) check(problem);
  check_scales(experiment);
}

namespace {

/// Runs the cells of an experiment, then scores them.
class Runner {
 public:
  /// \param store  nullptr: none
  Runner(const Experiment& experiment, const ExperimentOptions& options, RunStore* store)
      : experiment_(experiment), options_(options), store_(store), begin_(std::chrono::steady_clock::now()) {
    check(experiment);
    const std::size_t cells = experiment.problems.size() * experiment.strategies.size() * experiment.seeds.size();
    if (cells > most_runs) {
      throw Error(fmt::format("experiment: {} problems x {} strategies x {} seeds are {} runs; at most {}",
                              experiment.problems.size(), experiment.strategies.size(), experiment.seeds.size(), cells,
                              most_runs));
    }
    result_.runs.resize(cells);
    finished_.resize(cells, 0);
  }

  /// \throws Interrupted
  void plan() {
    const std::vector<std::size_t> order = order_of_cells(experiment_);
    in_parallel(order.size(), options_.jobs, [&](std::size_t turn) {
      const std::size_t index = order[turn];
      try {
        if (interrupted()) throw Interrupted();
        // Each cell writes to its own element: threads share no data, and their speed does not affect the order.
        const Cell cell(experiment_, index);
        RunResult run = run_cell(cell.strategy.first, cell.strategy.second, cell.problem, cell.seed,
                                 {.shortcut = experiment_.shortcut,
                                  .interrupted = [this] { return interrupted(); },
                                  .measured = experiment_.measure.has_value(),
                                  .threads = options_.threads});
        if (run.run.status == Status::interrupted) throw Interrupted();
        if (cell.seed == experiment_.seeds.front()) {
          check_unused_guides(cell.strategy.second, cell.problem, run.run);
        }
        // Outside of the run's time. Summaries have one thread.
        for (LevelResult& level : run.levels) level.rejections = rejections(level.record, cell.problem.resolution);
        if (store_ != nullptr) store_->planned(run);
        if (!experiment_.measure) release(run);
        result_.runs[index] = std::move(run);
        finished_[index] = 1;
        progress();
      } catch (...) {
        stop_.store(true);
        throw;
      }
    });
    refuse_impossible();
    planned_ = std::chrono::steady_clock::now();
    result_.planning_seconds = std::chrono::duration<double>(planned_ - begin_).count();
  }

  /// \throws Interrupted
  void measure() {
    if (!experiment_.measure) return;
    score(
        experiment_, result_, scoring_jobs(options_), [this] { progress(); }, [this] { return interrupted(); },
        options_.scope, store_);
    result_.measuring_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - planned_).count();
  }

  /// \throws Interrupted
  void ablate() {
    run_left_out(experiment_, result_, options_);
    run_uncoupled(experiment_, result_, options_);
  }

  ExperimentResult take() {
    // No later step uses the checkers, scenes and guides of the levels.
    for (RunResult& cell : result_.runs) release(cell);
    return std::move(result_);
  }
  /// What `plan` has finished before an interruption.
  ExperimentResult take_unmeasured() {
    result_.planning_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    return std::move(result_);
  }
  [[nodiscard]] const std::vector<char>& finished() const { return finished_; }

  static unsigned scoring_jobs(const ExperimentOptions& options) {
    return options.scoring_jobs > 0 ? options.scoring_jobs : std::max(1U, std::thread::hardware_concurrency());
  }

 private:
  /// A path where none can be is a fault of the program: nothing that it reports can then be believed.
  void refuse_impossible() const {
    for (const Problem& problem : experiment_.problems) {
      const auto solved = std::find_if(result_.runs.begin(), result_.runs.end(), [&](const RunResult& run) {
        return run.run.solved && run.problem == problem.name;
      });
      if (solved == result_.runs.end() || !separated(problem)) continue;
      throw Fault(fmt::format("problem '{}': {}, seed {}, reports a path, and obstacles separate start and goal",
                              problem.name, solved->strategy, solved->seed));
    }
  }

  [[nodiscard]] bool interrupted() const {
    return stop_.load(std::memory_order_relaxed) || (options_.interrupted && options_.interrupted());
  }
  void progress() {
    const std::scoped_lock lock(mutex_);
    ++done_;
    if (options_.progress && !stop_.load()) options_.progress(done_, steps(experiment_));
  }

  const Experiment& experiment_;
  const ExperimentOptions& options_;
  RunStore* store_;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point planned_;
  ExperimentResult result_;
  std::vector<char> finished_;     ///< by cell, written by the threads, each to its own
  std::atomic<bool> stop_{false};  ///< a failure in one cell stops the planning of the others
  std::mutex mutex_;               ///< guards `done_`
  std::size_t done_ = 0;
};

/// Problems and seeds of an experiment, by their indices.
struct Part {
  std::vector<std::size_t> problems;
  std::vector<std::size_t> seeds;
};

/// The largest part of which every run is finished: the seeds of some problem, for all problems that have finished
/// them.
Part largest_part(const Experiment& experiment, const std::vector<char>& finished) {
  const std::size_t strategies = experiment.strategies.size();
  const std::size_t seeds = experiment.seeds.size();
  std::vector<std::vector<std::size_t>> of_problem(experiment.problems.size());
  for (std::size_t p = 0; p < of_problem.size(); ++p) {
    for (std::size_t s = 0; s < seeds; ++s) {
      bool all = true;
      for (std::size_t k = 0; k < strategies; ++k) all = all && finished[(p * strategies + k) * seeds + s] != 0;
      if (all) of_problem[p].push_back(s);
    }
  }
  Part best;
  for (const auto& wanted : of_problem) {
    Part part{{}, wanted};
    for (std::size_t p = 0; p < of_problem.size(); ++p) {
      const auto& has = of_problem[p];
      if (std::includes(has.begin(), has.end(), wanted.begin(), wanted.end())) part.problems.push_back(p);
    }
    if (part.problems.size() * part.seeds.size() > best.problems.size() * best.seeds.size()) best = std::move(part);
  }
  return best;
}

std::string text_of(const Part& part, const Experiment& experiment) {
  std::vector<std::uint64_t> seeds;
  for (const std::size_t s : part.seeds) seeds.push_back(experiment.seeds[s]);
  const bool all = seeds.size() == experiment.seeds.size();
  const bool row = !seeds.empty() && seeds.back() - seeds.front() + 1 == seeds.size();
  std::string text = seeds.size() == 1 ? fmt::format("seed {}", seeds.front())
                     : row             ? fmt::format("seeds {} to {}", seeds.front(), seeds.back())
                                       : fmt::format("seeds {}", fmt::join(seeds, ", "));
  if (!all) text += fmt::format(" of {}", experiment.seeds.size());
  if (experiment.problems.size() == 1) return text;
  std::vector<std::string> problems;
  for (const std::size_t p : part.problems) problems.push_back(experiment.problems[p].name);
  return fmt::format("{} of the problem{} {}", text, problems.size() == 1 ? "" : "s", fmt::join(problems, ", "));
}

/// Reduces an experiment and its runs to a part of it.
void reduce(Experiment& experiment, ExperimentResult& result, const Part& part) {
  const std::size_t strategies = experiment.strategies.size();
  const std::size_t seeds = experiment.seeds.size();
  std::vector<RunResult> runs;
  std::vector<Problem> problems;
  std::vector<std::uint64_t> kept;
  for (const std::size_t p : part.problems) {
    problems.push_back(experiment.problems[p]);
    for (std::size_t k = 0; k < strategies; ++k) {
      for (const std::size_t s : part.seeds) {
        runs.push_back(std::move(result.runs[(p * strategies + k) * seeds + s]));
      }
    }
  }
  for (const std::size_t s : part.seeds) kept.push_back(experiment.seeds[s]);
  const bool complete = problems.size() == experiment.problems.size();
  experiment.problems = std::move(problems);
  experiment.seeds = std::move(kept);
  if (!complete) experiment.groups.clear();
  result.runs = std::move(runs);
}

/// Removes the scores that an interrupted scoring left.
void forget_scores(ExperimentResult& result) {
  result.pooled.clear();
  for (RunResult& run : result.runs) {
    run.target = {};
    for (LevelResult& level : run.levels) {
      LevelResult unscored;
      unscored.record = std::move(level.record);
      unscored.rejections = std::move(level.rejections);
      level = std::move(unscored);
    }
    release(run);
  }
}

}  // namespace

ExperimentResult run(const Experiment& experiment, const ExperimentOptions& options) {
  Runner runner(experiment, options, nullptr);
  runner.plan();
  runner.measure();
  runner.ablate();
  return runner.take();
}

ExperimentResult run(const Experiment& experiment, const ExperimentOptions& options, RunStore& store) {
  Runner runner(experiment, options, &store);
  runner.plan();
  runner.measure();
  runner.ablate();
  return runner.take();
}

ExperimentResult run_or_part(Experiment& experiment, const ExperimentOptions& options, std::string& finished) {
  finished.clear();
  Runner runner(experiment, options, nullptr);
  bool planned = false;
  bool measured = false;
  try {
    runner.plan();
    planned = true;
    runner.measure();
    measured = true;
    runner.ablate();
    return runner.take();
  } catch (const Interrupted&) {
    if (measured) {
      finished = "all runs, without those that decide which levels pay";
      return runner.take();
    }
    const Part part = largest_part(experiment, runner.finished());
    if (part.seeds.empty()) throw;
    ExperimentResult result = runner.take_unmeasured();
    const auto without_scores = [&] {
      finished += ", without their efficiencies";
      forget_scores(result);
      experiment.measure.reset();
    };
    if (planned) {
      finished = "all runs";
      without_scores();
      return result;
    }
    finished = text_of(part, experiment);
    reduce(experiment, result, part);
    if (experiment.measure) {
      // The user who interrupts a run waits for its end.
      constexpr double patience = 3.0;
      const auto begin = std::chrono::steady_clock::now();
      const auto passed = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      };
      try {
        score(
            experiment, result, Runner::scoring_jobs(options), [] {}, [&] { return passed() > patience; },
            options.scope);
        result.measuring_seconds = passed();
      } catch (const Interrupted&) {
        without_scores();
      }
    }
    for (RunResult& cell : result.runs) release(cell);
    return result;
  }
}

}  // namespace trellis
