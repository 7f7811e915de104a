// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/experiment/rejections.hpp>
#include <trellis/experiment/search_metrics.hpp>
#include <trellis/measure/censored_cost.hpp>
#include <trellis/measure/efficiency.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/measure/target.hpp>
#include <trellis/results/facts.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// A target that a user defines: a distribution over the root's space. Every level's samples are lifted to be scored.
struct UserTarget : TargetSettings {
  /// The context of the calls of its functions; scoring updates it.
  struct ScoredSamples {
    const Problem* problem = nullptr;
    std::string strategy;
    std::uint64_t seed = 0;
    std::string level;                        ///< the scored level (level_path), "" while the target is drawn
    std::string role;                         ///< the role of its samples: "node", "proposal"
    const Configurations* samples = nullptr;  ///< the samples; nullptr while the target is drawn
  };
  struct Context {
    const Problem& problem;
    const Configurations& path;                        ///< the run's path
    std::int64_t draws = 0;                            ///< the requested number of draws
    std::uint64_t seed = 0;                            ///< the seed of the draws
    std::shared_ptr<const ScoredSamples> scored = {};  ///< of this call, and of later calls of the density
  };
  /// Called from the thread that called run(), in a fixed order.
  std::function<Target::Distribution(const Context&)> make;
};

/// The target of the measure.
using TargetSpec = std::variant<TubeSettings, NearOptimalSettings, ProgressSettings, UserTarget>;
/// Returns the name of its component: "tube", "near_optimal", "progress", "target".
std::string target_name(const TargetSpec& target);
/// Returns it in words: "valid configurations within 0.5 m (full metric) of the path".
std::string target_text(const TargetSpec& target);
const TargetSettings& common_settings(const TargetSpec& target);

/// How to score an experiment's samples.
struct Measure {
  TargetSpec target = TubeSettings{};
  /// The first estimator that has a value gives the headline. Of the default list, scoring uses that one only, which
  /// saves half of the work; of any other list it reports all.
  std::vector<EstimatorSpec> estimators = default_estimators();
  /// The number of other seeds whose paths each run is also scored on; 0: none. All strategies use the same paths.
  std::int64_t cross = 2;
  /// Whether the lower levels are scored on these seeds' paths in their own spaces too, not only lifted to the root's.
  bool cross_levels = false;
  /// Whether to compute the metrics of each level's roadmap, information and wasted samples too.
  bool metrics = false;
};

/// A strategy of an experiment that is another strategy without one guide.
struct AblationLink {
  std::string strategy;  ///< its name
  std::string of;        ///< the name of the complete strategy
  std::string text;      ///< "without shrink(0.5)"
  std::string key;       ///< of that guide in the complete strategy, Ablation::key
  /// Whether the guides of the removed guide remain; else they are removed too.
  bool skipped = false;
};

/// Problems that reports of costs list together.
struct ProblemGroup {
  std::string name;
  std::vector<std::string> problems;  ///< names
  bool tuned = false;                 ///< the strategies were tuned on these; else they are held out
};

/// Problems x strategies x seeds, and how to score them.
struct Experiment {
  std::vector<Problem> problems;                                 ///< names are unique
  std::vector<std::pair<std::string, StrategySpec>> strategies;  ///< in the order of the report; names are unique
  std::vector<std::uint64_t> seeds;
  std::optional<Measure> measure = Measure{};  ///< none: no efficiency is computed
  std::int64_t shortcut = 0;                   ///< rounds of shortcutting on each found path before its report
  std::string baseline;                        ///< the strategy to compare the others with; "": baseline_of()
  std::vector<AblationLink> ablations;         ///< the strategies that ablate() added
  /// The budget of the runs without each guide that decide which guides pay (LeftOut), as a multiple of the work of the
  /// experiment; 0: none.
  double ablation = 0.0;
  std::vector<ProblemGroup> groups;  ///< of some of the problems; no problem is in two
};

/// Returns the strategy to compare the others with: the named one, else the first without a guide, else the first. ""
/// for fewer than two strategies, not counting ablations.
std::string baseline_of(const Experiment& experiment);

/// Appends, for each strategy in `names`, copies with one guide removed; reports compare each copy with the complete
/// strategy.
/// \throws Error for an unknown name and for a strategy without a guide.
void ablate(Experiment& experiment, const std::vector<std::string>& names);

struct LevelResult : LevelScores {
  LevelRecord record;
  std::optional<Rejections> rejections = {};  ///< computed by the thread that planned; none: in summaries
};

struct ExperimentResult;

/// One cell: a problem, a strategy, a seed.
struct RunResult {
  std::string problem;
  std::string strategy;
  std::uint64_t seed = 0;
  RunRecord run;                    ///< its `levels` have moved into the ones below
  double cpu_seconds = 0.0;         ///< CPU time of the planning thread: includes set-up, excludes scoring
  std::vector<LevelResult> levels;  ///< scoring releases the validity closures
  /// Points of the root's target, with its distribution; none without a path, or where the target does not lie in the
  /// root's space.
  Configurations target = {};
  std::vector<std::string> reasons = {};  ///< why it found no path (unsolved_reasons)
};

/// Returns the plain data of a run.
RunFacts facts_of(const RunResult& run);

/// Returns the runs of a strategy on a problem, in the order of the result; with an empty `problem`, on all problems.
std::vector<const RunResult*> select_runs(const ExperimentResult& result, const std::string& problem,
                                          const std::string& strategy);

struct ExperimentResult {
  std::vector<RunResult> runs;         ///< by problem, strategy, seed, for any number of threads
  std::vector<PooledScores> pooled;    ///< by problem, strategy and level; none without two seeds and a path
  std::vector<LeftOut> left_out = {};  ///< by problem, strategy, guide; none where a strategy of the experiment serves
  std::vector<Uncoupled> uncoupled = {};  ///< by problem, strategy, robots
  double planning_seconds = 0.0;          ///< wall clock of all runs
  double measuring_seconds = 0.0;         ///< wall clock of their scoring
};

/// Returns the object `experiment` of the document, on one line without its end.
std::string experiment_line(const Experiment& experiment);

/// Returns the plain data of an experiment and its runs. Where a strategy solves fewer than half of its runs on a
/// problem, examines why. \param script  the path as given on the command line, "" for none
ExperimentFacts facts_of(const Experiment& experiment, const ExperimentResult& result, const std::string& script = "");

/// The scores that an experiment computes.
enum class ScoreScope : std::uint8_t {
  all,
  /// What the overview prints: each level lifted to the root's space, on the paths of other seeds (on the run's own
  /// path where there are none), and pooled. A quarter of the work.
  overview
};

struct ExperimentOptions {
  unsigned jobs = 1;     ///< number of concurrent cells
  unsigned threads = 1;  ///< of each run, see ExecuteOptions
  /// Threads for scoring, after all cells have run and no time is measured any more; 0: as many as the machine has.
  unsigned scoring_jobs = 0;
  ScoreScope scope = ScoreScope::all;
  /// Called after each cell's run and after its scoring, from one thread at a time, with the numbers of finished and of
  /// all steps.
  std::function<void(std::size_t, std::size_t)> progress = {};
  /// The same for the runs without each guide, after the steps above.
  std::function<void(std::size_t, std::size_t)> ablation_progress = {};
  /// Called between cells and, through the executor, between proposals; true stops the experiment (Interrupted). Called
  /// from the threads of all jobs concurrently.
  std::function<bool()> interrupted = {};
};

/// Thrown when ExperimentOptions::interrupted returns true.
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(const std::string& what = "interrupted") : std::runtime_error(what) {}
};

/// Returns the total that ExperimentOptions::progress counts to: runs, and their scoring.
std::size_t steps(const Experiment& experiment);

/// Checks every problem and strategy without planning: repeated names and seeds, coordinates, bounds, start and goal in
/// collision (names the obstacle), settings of the measure. (Constructors of specs check that planners fit their
/// spaces.)
/// \throws Error on the first fault.
void check(const Experiment& experiment);

/// Checks, runs every cell, then scores them; scoring changes no run and is not part of the run's time. Then it runs
/// the strategies without each of their guides (Experiment::ablation). Cells run problem by problem and seed by seed,
/// with the strategies of a seed in a random order, so that a machine that slows down affects all strategies alike.
/// Except for times, the result does not depend on this order or on the number of threads. An exception in a cell stops
/// the others and is rethrown here.
ExperimentResult run(const Experiment& experiment, const ExperimentOptions& options = {});

}  // namespace trellis
