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

#include <trellis/experiment/search_metrics.hpp>
#include <trellis/measure/efficiency.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/measure/target.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// A target that a user defines. It is a distribution over the root's space, so every level is scored on it lifted.
struct UserTarget : TargetSettings {
  /// What its functions are being called for, kept up to date while an experiment is scored.
  struct Occasion {
    const Problem* problem = nullptr;
    std::string strategy;
    std::uint64_t seed = 0;
    std::string level;                        ///< whose samples are scored (level_path), "" while the target is drawn
    std::string role;                         ///< what these are: "node", "proposal"
    const Configurations* samples = nullptr;  ///< these; nullptr while the target is drawn
  };
  struct Context {
    const Problem& problem;
    const Configurations& path;                     ///< the run's path
    std::int64_t draws = 0;                         ///< how many are wanted
    std::uint64_t seed = 0;                         ///< for drawing them
    std::shared_ptr<const Occasion> occasion = {};  ///< of this call, and of those of the density later on
  };
  /// Called from the thread that called run(), in a fixed order.
  std::function<Target::Distribution(const Context&)> make;
};

/// What the samples are measured against.
using TargetSpec = std::variant<TubeSettings, NearOptimalSettings, ProgressSettings, UserTarget>;
/// The name of its component: "tube", "near_optimal", "progress", "target".
std::string target_name(const TargetSpec& target);
const TargetSettings& common_settings(const TargetSpec& target);

/// How an experiment's samples are scored.
struct Measure {
  TargetSpec target = TubeSettings{};
  /// The first that has a figure gives the headline. Of the default list it alone is asked, which spares half of the
  /// work; of any other list the others stand beside it.
  std::vector<EstimatorSpec> estimators = default_estimators();
  /// Paths of other seeds that each run is scored on besides its own; 0: none. The same paths for all strategies.
  std::int64_t cross = 4;
  /// Whether each level's roadmap, information and wasted samples are measured too.
  bool metrics = false;
};

/// A strategy of an experiment that is another one with a guide taken out.
struct AblationLink {
  std::string strategy;  ///< its name
  std::string of;        ///< the name of the whole strategy
  std::string text;      ///< "without shrink(0.5)"
};

/// What somebody published of an experiment, to be set beside what comes out here.
struct Publication {
  /// SE of the root's tree and expansion, nats; NaN: not given.
  struct Entry {
    std::string problem;
    std::string strategy;
    double tree = std::numeric_limits<double>::quiet_NaN();
    double expansion = std::numeric_limits<double>::quiet_NaN();
  };
  /// A sentence that the results are to bear out: SE of a strategy is lower than that of others, or is not.
  struct Claim {
    enum class Role : std::uint8_t { tree, expansion };
    std::string text;
    std::string problem;
    std::string strategy;
    bool lower = true;
    std::vector<std::string> than;  ///< strategies
    std::vector<Role> roles;
  };
  std::string source;  ///< a citation
  std::vector<Entry> entries;
  std::vector<Claim> claims;
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
  std::int64_t shortcut = 0;                   ///< rounds of shortcutting on each found path before it is reported
  std::string baseline;                        ///< the strategy that the others are compared with; "": the first
  std::vector<AblationLink> ablations;         ///< of the strategies, those made by ablate()
  std::optional<Publication> published;        ///< what to set the results beside
  std::vector<ProblemGroup> groups;            ///< of some of the problems; no problem is in two
};

/// Adds, after the strategies, those of `names` with each guide taken out in turn; each is compared with the whole one.
/// Throws Error for an unknown name and for a strategy without a guide.
void ablate(Experiment& experiment, const std::vector<std::string>& names);

/// One level's samples scored against one path, tree and expansion.
struct Scores {
  Efficiency tree;
  Efficiency expansion;
};

struct LevelResult {
  LevelRecord record;
  /// In the level's own space against the level's own path (the root's: the run's reported path). None without a target
  /// of its own. A role without samples, and a target without any valid configuration, score NaN.
  std::optional<Scores> own = {};
  /// Lifted to the root space by the chain of h's, against the root's path. None when the root found no path.
  std::optional<Scores> root = {};
  /// The same on the paths of other seeds, the mean over them. In the level's own space: on the same level's paths
  /// under the same strategy. Lifted: on the paths that all strategies of the problem are scored on.
  std::optional<Scores> own_cross = {};
  std::optional<Scores> root_cross = {};
  /// root_cross (or root, without other seeds) of `equal_samples` of the samples drawn at random: as many as the
  /// strategy with the fewest has, where numbers differ much. The root level only.
  std::optional<Scores> equal = {};
  /// What frames the root's figures on its own path, with as many samples as it has, but `most_references` at the most:
  /// the oracle, which draws from T itself (S = C with the solution known), and uniform sampling of C. The root level
  /// only, scored by the headline's estimators.
  std::optional<Scores> oracle = {};
  std::optional<Scores> uniform = {};
  static constexpr std::size_t most_references = 2000;
  std::optional<SearchMetrics> metrics = {};
};

/// One cell: a problem, a strategy, a seed.
struct RunResult {
  std::string problem;
  std::string strategy;
  std::uint64_t seed = 0;
  RunRecord run;                    ///< its `levels` have moved into the ones below
  double cpu_seconds = 0.0;         ///< CPU time of the thread that planned: set-up included, scoring excluded
  std::vector<LevelResult> levels;  ///< the validity closures are released once the run is scored
  /// Points of the target that the root was scored on, spread as it is; none without a path, or where the target does
  /// not lie in the root's space.
  Configurations target = {};
};

/// The root's samples of all seeds of a strategy taken together, on the paths that single runs are scored on. On each
/// path the seed that found it is left out, as a run is never scored on its own path there. What one run tells differs
/// from it: a mixture of distributions that lie in different places covers what each of them misses.
struct PooledScores {
  std::string problem;
  std::string strategy;
  std::size_t seeds = 0;    ///< taken together on a path
  std::size_t targets = 0;  ///< paths; the scores are means over them
  Scores scores;
};

struct ExperimentResult {
  std::vector<RunResult> runs;       ///< by problem, strategy, seed, whatever the number of threads
  std::vector<PooledScores> pooled;  ///< by problem and strategy; none of those without two seeds and a path
  double planning_seconds = 0.0;     ///< wall clock of all runs
  double measuring_seconds = 0.0;    ///< wall clock of scoring them
};

struct ExperimentOptions {
  unsigned jobs = 1;  ///< cells run at the same time
  /// Threads that score, once all cells have run and no time is taken any more; 0: as many as the machine has.
  unsigned scoring_jobs = 0;
  /// Called after each cell's run and each cell's scoring, from one thread at a time: done, in all.
  std::function<void(std::size_t, std::size_t)> progress = {};
  /// Asked between cells and, through the executor, between proposals; true ends the experiment early (Interrupted).
  /// Called from the threads of all jobs at once.
  std::function<bool()> interrupted = {};
};

/// Thrown when ExperimentOptions::interrupted said so.
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(const std::string& what = "interrupted") : std::runtime_error(what) {}
};

/// What ExperimentOptions::progress counts to: runs, and their scoring.
std::size_t steps(const Experiment& experiment);

/// Checks every problem and strategy without planning: names and seeds that repeat, coordinates, bounds, start and goal
/// in collision (naming the obstacle), settings of the measure. Throws Error. (That planners fit their spaces is
/// checked where specs are made.)
void check(const Experiment& experiment);

/// Checks, runs every cell, then scores them; scoring changes no run and is not in the run's time. Cells run problem by
/// problem and seed by seed, the strategies of a seed in a random order, so that a machine that slows down affects all
/// strategies alike. The result does not depend on this order or on the number of threads, times apart. An exception in
/// a cell stops the others and is rethrown here.
ExperimentResult run(const Experiment& experiment, const ExperimentOptions& options = {});

}  // namespace trellis
