// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/experiment.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

/// Keeps the shifts of the measure apart from the run's own seed. They depend on the seed alone, not on problem or
/// strategy, so that two runs that found the same path are scored at the same points.
constexpr std::uint64_t measure_seed = 0x7472656c6c697300;

void check_name(const char* one, const char* many, const std::string& name, std::set<std::string>& taken) {
  if (name.empty()) throw Error(fmt::format("experiment: a {} without a name", one));
  if (!taken.insert(name).second) throw Error(fmt::format("experiment: two {} are called '{}'", many, name));
}

/// The ranges are those of the registry, so that C++ callers are held to what scripts are held to.
void check(const TubeSettings& settings) {
  const Component& component = tube_settings().component();
  const std::vector<Options::Entry> all = {{"delta", settings.delta},     {"distance", settings.distance},
                                           {"support", settings.support}, {"epsilon", settings.epsilon},
                                           {"points", settings.points},   {"pool", settings.pool}};
  std::vector<Options::Entry> given;
  std::copy_if(all.begin(), all.end(), std::back_inserter(given),
               [&](const Options::Entry& entry) { return component.find(entry.first) != nullptr; });
  static_cast<void>(Options::validate(component, given));
}

/// One cell's place in the fixed order of the result: by problem, strategy, seed.
struct Cell {
  const Problem& problem;
  const std::pair<std::string, StrategySpec>& strategy;
  std::uint64_t seed;

  Cell(const Experiment& experiment, std::size_t index)
      : problem(experiment.problems[index / experiment.seeds.size() / experiment.strategies.size()]),
        strategy(experiment.strategies[index / experiment.seeds.size() % experiment.strategies.size()]),
        seed(experiment.seeds[index % experiment.seeds.size()]) {}
};

Efficiency score(const Target& target, const Configurations& samples, Held held = Held::anything) {
  if (!target.empty() && !samples.empty()) return efficiency(target, samples, held);
  Efficiency none;  // no figure; what uniform sampling would have had stands where there is a target
  none.samples = samples.size();
  if (target.empty()) {
    none.flags = {"empty target"};
  } else {
    none.uniform = target.uniform();
  }
  return none;
}

Target make_target(const LevelRecord& level, const Configurations& path, const TubeSettings& settings,
                   std::uint64_t seed) {
  const bool planar = settings.distance == "planar";
  return {level.space, path,        planar ? level.position_axes : std::vector<std::size_t>{},
          settings,    level.valid, measure_seed + seed};
}

void score(RunResult& result, const TubeSettings& settings, const std::function<bool()>& interrupted) {
  if (result.levels.empty()) return;
  const LevelRecord& top = result.levels.front().record;
  std::optional<Target> root;
  if (result.run.solved && !result.run.path.empty()) {
    root.emplace(make_target(top, result.run.path, settings, result.seed));
  }
  for (auto& level : result.levels) {
    if (interrupted()) throw Interrupted();
    const LevelRecord& record = level.record;
    // What entered a tree was found valid in the level's own space; lifted to the root it may be anything again.
    const Held held = find_planner(record.planner)->unverified ? Held::anything : Held::valid_only;
    if (root) {
      level.root = Scores{score(*root, record.root_nodes, record.level == 0 ? held : Held::anything),
                          score(*root, record.root_proposals)};
    }
    if (&record == &top) {
      level.own = level.root;
    } else if (record.solution.solved() && !record.solution.path.empty()) {
      const Target own = make_target(record, record.solution.path, settings, result.seed);
      level.own = Scores{score(own, record.search.nodes, held), score(own, record.search.proposals)};
    }
  }
}

RunResult run_cell(const Experiment& experiment, const Cell& cell, const std::function<bool()>& interrupted) {
  RunResult result;
  result.problem = cell.problem.name;
  result.strategy = cell.strategy.first;
  result.seed = cell.seed;
  result.run = execute(cell.strategy.second, cell.problem, cell.seed, {experiment.shortcut, interrupted});
  if (result.run.status == Status::interrupted) throw Interrupted();
  for (auto& record : result.run.levels) result.levels.push_back({std::move(record), {}, {}});
  result.run.levels.clear();
  if (experiment.measure) score(result, *experiment.measure, interrupted);
  // The closures hold a level's checker and scene, which nobody asks again.
  for (auto& level : result.levels) level.record.valid = nullptr;
  return result;
}

}  // namespace

void check(const Experiment& experiment) {
  if (experiment.problems.empty()) throw Error("experiment: no problem given");
  if (experiment.strategies.empty()) throw Error("experiment: no strategy given");
  if (experiment.seeds.empty()) throw Error("experiment: no seed given");
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
  for (const auto& problem : experiment.problems) check(problem);
}

ExperimentResult run(const Experiment& experiment, const ExperimentOptions& options) {
  check(experiment);

  const std::size_t cells = experiment.problems.size() * experiment.strategies.size() * experiment.seeds.size();
  ExperimentResult result;
  result.runs.resize(cells);

  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;  // guards what follows
  std::size_t done = 0;
  std::exception_ptr failure;

  const std::function<bool()> interrupted = [&] {
    return stop.load(std::memory_order_relaxed) || (options.interrupted && options.interrupted());
  };
  const auto work = [&] {
    while (!stop.load()) {
      const std::size_t index = next.fetch_add(1);
      if (index >= cells) return;
      try {
        if (interrupted()) throw Interrupted();
        // Each cell has its own place: nothing is shared, and the order does not depend on who is quicker.
        result.runs[index] = run_cell(experiment, Cell(experiment, index), interrupted);
        const std::scoped_lock lock(mutex);
        ++done;
        if (options.progress && !stop.load()) options.progress(done, cells);
      } catch (...) {
        // The first one counts: those that follow were only told to stop.
        const std::scoped_lock lock(mutex);
        if (!failure) failure = std::current_exception();
        stop.store(true);
      }
    }
  };

  {
    std::vector<std::jthread> others;  // beside the caller's own thread
    const std::size_t jobs = std::min<std::size_t>(std::max(1U, options.jobs), cells);
    for (std::size_t i = 1; i < jobs; ++i) others.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
  return result;
}

}  // namespace trellis
