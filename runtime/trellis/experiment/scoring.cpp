// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/scoring.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <mutex>
#include <numeric>

#include <trellis/base/parallel.hpp>
#include <trellis/base/polling.hpp>
#include <trellis/experiment/targets.hpp>
#include <trellis/measure/hitting.hpp>
#include <trellis/measure/samples.hpp>
#include <trellis/measure/statistics.hpp>

namespace trellis {

namespace {

// Points of a target for the scores on other runs' paths and of lower levels: fewer than for the root's own path.
constexpr std::int64_t few_points = 512;
constexpr std::int64_t small_pool = 2048;
constexpr std::size_t kept_points = 2048;    // of each run's target, for drawings
constexpr std::size_t pooled_samples = 500;  // of each run, in the pool of all seeds
// Hitting: samples of each run, and of the pool of all seeds, of which all strategies have the same number.
constexpr std::size_t hitting_samples = 2000;
constexpr std::size_t least_hitting = 600;
constexpr std::size_t most_hitting = 4000;
// Numbers of samples within this factor of each other need no equalising.
constexpr double much_different = 2.0;

using TargetPointer = std::shared_ptr<const Target>;

/// Makes the functions of one run thread-safe: they share its checkers, of which only one thread may use each at a
/// time, while threads share targets.
void guard(RunResult& run) {
  const auto mutex = std::make_shared<std::mutex>();
  for (LevelResult& level : run.levels) {
    if (level.record.valid) {
      level.record.valid = [mutex, valid = std::move(level.record.valid)](View q) {
        const std::scoped_lock lock(*mutex);
        return valid(q);
      };
    }
    if (level.record.valid_motion) {
      level.record.valid_motion = [mutex, valid = std::move(level.record.valid_motion)](View a, View b) {
        const std::scoped_lock lock(*mutex);
        return valid(a, b);
      };
    }
  }
}

/// Returns a result without values that states the reason.
Efficiency none(std::size_t samples, const std::string& reason, bool empty_target) {
  Efficiency figure;
  figure.samples = samples;
  figure.reason = reason;
  if (empty_target) figure.flags = {"empty target"};
  return figure;
}

/// The run that provides the path for a tube of other runs.
struct Donor {
  const LevelResult* level = nullptr;
  const Configurations* path = nullptr;
  std::uint64_t seed = 0;
};

/// Returns the samples of a level's tree, from rows that correspond to its nodes. A configuration that the tree has
/// twice, such as that where the trees of rrt_connect meet, is one sample.
Configurations nodes_of(const LevelRecord& record, const Configurations& rows) {
  const Configurations samples = record.search.tree_samples(rows);
  std::vector<std::uint32_t> order(samples.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const View x = samples[a];
    const View y = samples[b];
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  };
  std::stable_sort(order.begin(), order.end(), before);
  std::vector<char> again(samples.size(), 0);
  for (std::size_t i = 1; i < order.size(); ++i) again[order[i]] = before(order[i - 1], order[i]) ? 0 : 1;
  Configurations once(samples.dimension());
  once.reserve(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (again[i] == 0) once.push(samples[i]);
  }
  return once;
}

class ProblemScoring {
 public:
  ProblemScoring(const Experiment& experiment, std::vector<RunResult*> runs, unsigned jobs,
                 const std::function<void()>& progress, const std::function<bool()>& interrupted, ScoreScope scope,
                 RunStore* store)
      : experiment_(experiment),
        measure_(*experiment.measure),
        runs_(std::move(runs)),
        // A script's functions run in the thread that owns its interpreter.
        jobs_(std::holds_alternative<UserTarget>(measure_.target) ? 1 : jobs),
        progress_(progress),
        interrupted_(interrupted),
        store_(std::holds_alternative<UserTarget>(measure_.target) ? nullptr : store),
        seeds_(experiment.seeds.size()),
        strategies_(experiment.strategies.size()),
        overview_(scope == ScoreScope::overview),
        users_(std::holds_alternative<UserTarget>(measure_.target)),
        headline_only_(measure_.estimators == default_estimators()),
        rough_intervals_(crosses() && seeds_ >= least_for_interval),
        together_(overview_ && rough_intervals_ && !users_ && experiment.problems.size() <= most_single_problems) {
    const auto problem = std::find_if(experiment.problems.begin(), experiment.problems.end(),
                                      [&](const Problem& p) { return p.name == runs_.front()->problem; });
    scored_->problem = &*problem;
    balls_.resize(runs_.size());
    balls_made_ = std::vector<std::once_flag>(runs_.size());
  }

  /// \param pooled  receives the pooled scores, appended
  void score(std::vector<PooledScores>& pooled) {
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (store_ != nullptr && store_->restore_scores(*runs_[i])) {
        progress_();
      } else {
        missing.push_back(i);
      }
    }
    const bool pooled_known = store_ != nullptr && store_->restore_pooled(runs_.front()->problem, pooled);
    if (missing.empty() && pooled_known) return;
    for (RunResult* run : runs_) guard(*run);
    if (!overview_) choose_equal_number();
    make_shared_targets();
    in_parallel(missing.size(), jobs_, [&](std::size_t i) {
      const PollScope polled(polled_);
      score_run(missing[i]);
      if (store_ != nullptr) store_->scored(*runs_[missing[i]]);
      progress_();
    });
    if (!pooled_known) score_pooled(pooled);
  }

 private:
  [[nodiscard]] RunResult& run(std::size_t strategy, std::size_t seed) const {
    return *runs_[strategy * seeds_ + seed];
  }
  void poll() const {
    if (interrupted_()) throw Interrupted();
  }

  // Targets ----------------------------------------------------------------------------------------------------------

  /// Returns the target that a run's path defines for a level; the root's path is the one that the run reports.
  [[nodiscard]] MadeTarget own_target(const RunResult& run, const LevelResult& level) const {
    const LevelRecord& record = level.record;
    const bool root = record.level == 0;
    const bool solved = root ? run.run.solved : record.solution.solved();
    const Configurations& path = root ? run.run.path : record.solution.path;
    if (const auto* settings = std::get_if<NearOptimalSettings>(&measure_.target)) {
      return make_near_optimal(record, *settings);
    }
    if (!solved || path.empty()) return {nullptr, "no path of its own"};
    if (const auto* settings = std::get_if<TubeSettings>(&measure_.target)) {
      TubeSettings tube = *settings;
      if (!root) {
        tube.points = std::min(tube.points, few_points);
        tube.pool = std::min(tube.pool, small_pool);
      }
      return make_tube(record, path, tube, measure_seed + run.seed);
    }
    if (const auto* user = std::get_if<UserTarget>(&measure_.target); user != nullptr && root) {
      const auto draws = std::max(user->pool, user->points);
      const Problem& problem = *scored_->problem;
      *scored_ = {&problem, run.strategy, run.seed, "", "", nullptr};
      return {std::make_shared<const Target>(Target::distribution(
                  record.space, *user, user->make({problem, path, draws, measure_seed + run.seed, scored_}))),
              ""};
    }
    return {nullptr, "the target lies in the root's space"};
  }

  /// Whether other strategies are scored on a strategy's paths: those of ablations would change the scores of the
  /// complete strategies.
  [[nodiscard]] bool gives_paths(std::size_t strategy) const {
    const std::string& name = experiment_.strategies[strategy].first;
    return std::none_of(experiment_.ablations.begin(), experiment_.ablations.end(),
                        [&](const AblationLink& link) { return link.strategy == name; });
  }

  [[nodiscard]] bool crosses() const {
    return measure_.cross > 0 && seeds_ > 1 &&
           (std::holds_alternative<TubeSettings>(measure_.target) ||
            std::holds_alternative<UserTarget>(measure_.target));
  }

  [[nodiscard]] static bool has_path(const RunResult& run) {
    return !run.levels.empty() && run.run.solved && !run.run.path.empty();
  }

  /// Returns the strategies by their names: which paths score the runs does not depend on the order of the experiment.
  [[nodiscard]] std::vector<std::size_t> by_name() const {
    std::vector<std::size_t> order(strategies_);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return runs_[a * seeds_]->strategy < runs_[b * seeds_]->strategy; });
    return order;
  }

  /// For each seed, chooses the runs whose paths score all strategies: those of the next seeds, with the strategies in
  /// turn.
  void choose_donors() {
    std::vector<std::size_t> givers;
    for (const std::size_t s : by_name()) {
      if (gives_paths(s)) givers.push_back(s);
    }
    const auto wanted = static_cast<std::size_t>(measure_.cross);
    donors_.resize(seeds_);
    for (std::size_t seed = 0; seed < seeds_; ++seed) {
      for (std::size_t lap = 0; lap < givers.size() && donors_[seed].size() < wanted; ++lap) {
        for (std::size_t k = 1; k < seeds_ && donors_[seed].size() < wanted; ++k) {
          const std::size_t other = (seed + k) % seeds_;
          // The strategies take turns by seed, each seed with one, or the first after it that found a path.
          for (std::size_t turn = 0; turn < givers.size(); ++turn) {
            const std::size_t index = givers[(other + lap + turn) % givers.size()] * seeds_ + other;
            const bool taken = std::find(donors_[seed].begin(), donors_[seed].end(), index) != donors_[seed].end();
            if (taken || !has_path(*runs_[index])) continue;
            donors_[seed].push_back(index);
            break;
          }
        }
      }
    }
  }

  /// Makes the targets that several runs are scored on: those of the donors' roots and, with `cross_levels`, of all
  /// lower levels. `score_run` makes the others.
  void make_shared_targets() {
    root_targets_.resize(runs_.size());
    level_targets_.resize(runs_.size());
    donors_.resize(seeds_);
    if (!crosses()) return;
    choose_donors();
    std::vector<char> gives(runs_.size(), 0);
    for (const auto& donors : donors_) {
      for (const std::size_t donor : donors) gives[donor] = 1;
    }
    if (together_) {
      make_few_targets(gives);
      return;
    }
    in_parallel(runs_.size(), jobs_, [&](std::size_t i) {
      const PollScope polled(polled_);
      poll();
      const RunResult& result = *runs_[i];
      if (gives[i] != 0) root_targets_[i] = own_target(result, result.levels.front());
      if (!measure_.cross_levels || overview_) return;
      level_targets_[i].resize(result.levels.size());
      for (std::size_t l = 1; l < result.levels.size(); ++l) {
        level_targets_[i][l] = own_target(result, result.levels[l]);
      }
    });
  }

  /// Makes the targets of the pool only, and chooses one of them for each seed: the overview prints pooled figures, and
  /// of single runs where they disagree and which part of the divergence explains a verdict.
  void make_few_targets(const std::vector<char>& gives) {
    const PollScope polled(polled_);
    std::vector<std::size_t> chosen;
    for (const std::size_t strategy : by_name()) {
      for (std::size_t seed = 0; seed < seeds_; ++seed) {
        if (chosen.size() == static_cast<std::size_t>(measure_.cross)) break;
        const std::size_t i = strategy * seeds_ + seed;
        const auto same_seed = [&](std::size_t other) { return other % seeds_ == seed; };
        if (gives[i] == 0 || std::any_of(chosen.begin(), chosen.end(), same_seed)) continue;
        root_targets_[i] = own_target(*runs_[i], runs_[i]->levels.front());
        if (root_targets_[i]->target) chosen.push_back(i);
      }
    }
    for (std::size_t seed = 0; seed < seeds_; ++seed) {
      donors_[seed].clear();
      const auto other =
          std::find_if(chosen.begin(), chosen.end(), [&](std::size_t donor) { return donor % seeds_ != seed; });
      if (other != chosen.end()) donors_[seed].push_back(*other);
    }
  }

  /// Returns the targets of the same level under other seeds.
  [[nodiscard]] std::vector<TargetPointer> level_targets(std::size_t index, const LevelRecord& record) const {
    std::vector<TargetPointer> targets;
    const std::size_t strategy = index / seeds_;
    const std::size_t seed = index % seeds_;
    for (std::size_t k = 1; k < seeds_ && targets.size() < static_cast<std::size_t>(measure_.cross); ++k) {
      const std::size_t other = strategy * seeds_ + (seed + k) % seeds_;
      const auto& levels = runs_[other]->levels;
      for (std::size_t l = 1; l < level_targets_[other].size(); ++l) {
        const TargetPointer& target = level_targets_[other][l].target;
        if (target && levels[l].record.key == record.key && levels[l].record.space == record.space) {
          targets.push_back(target);
        }
      }
    }
    return targets;
  }

  // Scoring ----------------------------------------------------------------------------------------------------------

  /// A level's samples in one space, prepared for all targets there.
  struct Sets {
    PreparedSamples tree;
    PreparedSamples expansion;
    SampleSupport support = SampleSupport::anything;  ///< of the tree
    std::function<double(View)> density = {};         ///< of the expansion
    bool brief = false;                               ///< uses the headline's estimator and `knn` only
    /// The unsorted samples; a script's function receives them as context.
    Configurations nodes = {};
    Configurations proposals = {};
  };
  [[nodiscard]] static Sets own_sets(const LevelRecord& record) {
    return {.tree = {record.space, nodes_of(record, record.search.nodes)},
            .expansion = {record.space, expansion(record, record.search.proposals)},
            .support = sample_support(record),
            .density = record.proposal_density,
            .brief = record.level != 0};
  }
  /// \param root  the root's space
  [[nodiscard]] Sets root_sets(const RunResult& run, const LevelRecord& record, const Space& root) const {
    // Tree nodes are valid in the level's own space; lifted to the root they may be invalid.
    Sets sets{.tree = {root, nodes_of(record, record.root_nodes())},
              .expansion = {root, expansion(record, record.root_proposals())},
              .support = record.level == 0 ? sample_support(record) : SampleSupport::anything,
              .density = record.root_proposal_density,
              .brief = record.level != 0};
    tell(run, record);
    if (users_) {
      sets.nodes = nodes_of(record, record.root_nodes());
      sets.proposals = expansion(record, record.root_proposals());
    }
    return sets;
  }

  /// Sets the context to the run and level that is being scored. A script's functions run in one thread, which alone
  /// reads it.
  void tell(const RunResult& run, const LevelRecord& record) const {
    if (!users_) return;
    scored_->strategy = run.strategy;
    scored_->seed = run.seed;
    scored_->level =
        level_path(record, [&](int i) -> const LevelRecord& { return run.levels[static_cast<std::size_t>(i)].record; });
  }
  /// Sets the samples of the context.
  void tell(const char* role, const Configurations& samples) const {
    if (!users_) return;
    scored_->role = role;
    scored_->samples = &samples;
  }

  /// The effort of a score.
  struct Effort {
    bool brief = false;       ///< uses the headline's estimator and `knn` only
    bool few_points = false;  ///< uses a part of the target's points
    bool pooled = false;      ///< of all seeds together: the interval uses all that there is
    bool interval = true;
  };
  [[nodiscard]] Efficiency figure(const Target& target, const PreparedSamples& samples, SampleSupport support,
                                  const std::function<double(View)>& density, Effort effort) const {
    poll();
    if (samples.total() == 0) {
      Efficiency result = none(0, "there are no samples", false);
      result.uniform = target.uniform();
      result.free_share = target.free_share();
      return result;
    }
    return efficiency(target, samples,
                      {.support = support,
                       .estimators = measure_.estimators,
                       .brief = effort.brief,
                       .headline_only = headline_only_,
                       .interval = effort.interval,
                       .rough_interval = rough_intervals_ && !effort.pooled,
                       .density = density,
                       .points = effort.few_points ? static_cast<std::size_t>(few_points) : 0,
                       .pool = effort.few_points ? static_cast<std::size_t>(small_pool) : 0});
  }

  /// \param shared  whether the path is another run's, or one of several
  [[nodiscard]] Scores scores(const Target& target, const Sets& sets, bool shared) const {
    const Effort effort{.brief = sets.brief, .few_points = shared || sets.brief};
    Scores found;
    tell("node", sets.nodes);
    found.tree = figure(target, sets.tree, sets.support, {}, effort);
    tell("proposal", sets.proposals);
    found.expansion = figure(target, sets.expansion, SampleSupport::anything, sets.density, effort);
    return found;
  }

  /// Scores perfect guidance and uniform sampling, to compare with a level's samples.
  void score_references(const Target& target, const Sets& sets, std::size_t index, LevelResult& level) {
    if (users_) return;  // it would call the script's density for samples of no run
    const Space& space = target.space();
    const double log_target = target.is_uniform() ? -target.log_volume() : 0.0;
    const auto score = [&](const Configurations& rows, const std::function<double(View)>& density) {
      if (rows.empty()) return none(0, "there are no samples", false);
      return efficiency(target, {space, rows},
                        {.support = SampleSupport::anything,
                         .estimators = measure_.estimators,
                         .headline_only = true,
                         .rough_interval = rough_intervals_,
                         .density = density,
                         .points = static_cast<std::size_t>(few_points),
                         .pool = static_cast<std::size_t>(small_pool)});
    };
    Scores oracle;
    Scores uniform;
    for (const bool tree : {true, false}) {
      const std::size_t count = std::min((tree ? sets.tree : sets.expansion).total(), LevelResult::most_references);
      const bool closed = !tree && sets.density && target.is_uniform();
      Stream stream(measure_seed + runs_[index]->seed, "", tree ? "oracle tree" : "oracle expansion");
      Efficiency& perfect = tree ? oracle.tree : oracle.expansion;
      const Configurations drawn = target.draw(count, stream);
      perfect = score(drawn, closed ? std::function<double(View)>(
                                          [&](View x) { return target.contains(x) ? std::exp(log_target) : 0.0; })
                                    : std::function<double(View)>());
      Configurations anywhere(space.dimension());
      Configuration x(space.dimension());
      for (std::size_t i = 0; i < count; ++i) {
        space.sample_uniform(stream, x);
        anywhere.push(x);
      }
      Efficiency& blind = tree ? uniform.tree : uniform.expansion;
      blind = score(anywhere, closed ? std::function<double(View)>([&](View) { return std::exp(-space.log_volume()); })
                                     : std::function<double(View)>());
      if (!hits()) continue;
      perfect.hitting = balls(index).hitting(drawn, {}, false);
      blind.hitting = balls(index).hitting(anywhere, {}, false);
    }
    level.oracle = std::move(oracle);
    level.uniform = std::move(uniform);
  }

  /// Returns the expansion's samples, from rows that correspond to a level's proposals.
  static Configurations expansion(const LevelRecord& record, const Configurations& rows) {
    return record.search.expands ? rows : Configurations(rows.dimension());
  }

  static SampleSupport sample_support(const LevelRecord& record) {
    return find_planner(record.planner)->unverified ? SampleSupport::anything : SampleSupport::valid_only;
  }

  template <class Score>
  static std::optional<Scores> mean_scores(const std::vector<TargetPointer>& targets, Score score) {
    if (targets.empty()) return std::nullopt;
    std::vector<Efficiency> tree;
    std::vector<Efficiency> expansion;
    for (const auto& target : targets) {
      Scores found = score(*target);
      tree.push_back(std::move(found.tree));
      expansion.push_back(std::move(found.expansion));
    }
    return Scores{mean(tree), mean(expansion)};
  }

  void score_run(std::size_t index) {
    poll();
    RunResult& result = *runs_[index];
    if (result.levels.empty()) return;
    if (const auto* progress = std::get_if<ProgressSettings>(&measure_.target)) {
      score_progress(result, *progress);
    } else {
      score_paths(index, result);
    }
    if (measure_.metrics) {
      for (LevelResult& level : result.levels) {
        poll();
        level.metrics = search_metrics(level.record.space, level.record.search, level.record.valid,
                                       level.record.valid_motion, {}, measure_seed);
      }
    }
  }

  /// Scores a level on other seeds' paths as far as the overview prints it. Beside pooled figures, single runs only
  /// show which part of the divergence of the nodes explains a verdict: that needs no interval, and no proposals.
  [[nodiscard]] std::optional<Scores> overview_scores(const std::vector<TargetPointer>& targets, const RunResult& run,
                                                      const LevelRecord& record) const {
    const Space& root = run.levels.front().record.space;
    if (!together_) {
      const Sets sets = root_sets(run, record, root);
      return mean_scores(targets, [&](const Target& target) { return scores(target, sets, true); });
    }
    const Effort effort{.brief = record.level != 0, .few_points = true, .interval = false};
    const Stream some(measure_seed + run.seed, record.key, "pooled nodes");
    const PreparedSamples nodes(root, thinned(nodes_of(record, record.root_nodes()), pooled_samples, some));
    return mean_scores(targets, [&](const Target& target) {
      const SampleSupport support = record.level == 0 ? sample_support(record) : SampleSupport::anything;
      return Scores{figure(target, nodes, support, {}, effort), none(0, "the overview has those of all seeds", false)};
    });
  }

  void score_paths(std::size_t index, RunResult& result) {
    std::vector<TargetPointer> crossing;
    for (const std::size_t donor : donors_[index % seeds_]) {
      if (root_targets_[donor]->target) crossing.push_back(root_targets_[donor]->target);
    }
    if (overview_ && !crossing.empty()) {
      for (LevelResult& level : result.levels) {
        level.root_cross = overview_scores(crossing, result, level.record);
        if (!together_) score_hitting(index, level);
      }
      return;
    }
    const MadeTarget root = root_targets_[index] ? *root_targets_[index] : own_target(result, result.levels.front());
    if (root.target) keep(*root.target, result.target);
    const Space& space = result.levels.front().record.space;
    for (LevelResult& level : result.levels) {
      const LevelRecord& record = level.record;
      if (root.target || !crossing.empty()) {
        const Sets sets = root_sets(result, record, space);
        if (root.target) level.root = scores(*root.target, sets, false);
        if (root.target && record.level == 0) score_references(*root.target, sets, index, level);
        level.root_cross = mean_scores(crossing, [&](const Target& target) { return scores(target, sets, true); });
      }
      if (!root.target && result.run.solved) level.root = absent(record, root.reason);
      score_hitting(index, level);
      if (record.level == 0) {
        level.own = level.root;
        level.own_cross = level.root_cross;
        continue;
      }
      score_own_space(index, result, level);
    }
    // A target that is the same for every run has no cross scores.
    if (std::holds_alternative<NearOptimalSettings>(measure_.target)) {
      for (LevelResult& level : result.levels) {
        level.own_cross = level.own;
        level.root_cross = level.root;
      }
    }
    tell(result, result.levels.front().record);
    score_equal_number(result.levels.front(), root, crossing);
  }

  void score_own_space(std::size_t index, const RunResult& result, LevelResult& level) const {
    const LevelRecord& record = level.record;
    const auto at = static_cast<std::size_t>(&level - result.levels.data());
    const MadeTarget own = level_targets_[index].empty() ? own_target(result, level) : level_targets_[index][at];
    const std::vector<TargetPointer> others = level_targets(index, record);
    if (own.target || !others.empty()) {
      const Sets sets = own_sets(record);
      if (own.target) level.own = scores(*own.target, sets, false);
      level.own_cross = mean_scores(others, [&](const Target& target) { return scores(target, sets, true); });
    }
    if (!own.target && record.solution.solved() && !std::holds_alternative<UserTarget>(measure_.target)) {
      level.own = absent(record, own.reason);
    }
  }

  /// Stores a subset of a target's points, with its distribution.
  static void keep(const Target& target, Configurations& kept) {
    const std::size_t count = std::min(target.pool().size(), kept_points);
    kept = Configurations(target.space().dimension());
    kept.reserve(count);
    for (std::size_t i = 0; i < count; ++i) kept.push(target.pool()[i]);
  }

  /// Returns the motion model of a level; nullptr where its motions are straight.
  [[nodiscard]] const MotionModel* model_of(const LevelRecord& record) const {
    const MotionModel* const model = scored_->problem->motion_model.get();
    const bool driven =
        model != nullptr && find_planner(record.planner)->kinodynamic && model->dimension() == record.space.dimension();
    return driven ? model : nullptr;
  }

  void score_progress(RunResult& result, const ProgressSettings& settings) const {
    for (LevelResult& level : result.levels) {
      Scores found;
      for (const bool tree : {true, false}) {
        const Ranks ranks =
            rank_motions(level.record, tree, settings, measure_seed + result.seed, model_of(level.record));
        Efficiency& role = tree ? found.tree : found.expansion;
        role = ranks.target.target ? figure(*ranks.target.target, {ranks.target.target->space(), ranks.samples},
                                            SampleSupport::anything, {},
                                            {.brief = level.record.level != 0, .few_points = level.record.level != 0})
                                   : none(ranks.samples.size(), ranks.target.reason, false);
      }
      level.own = found;
      level.own_cross = found;
      // Motions are not lifted: only the root's motions lie in the root's space.
      if (level.record.level == 0) {
        level.root = found;
        level.root_cross = found;
      }
    }
  }

  static Scores absent(const LevelRecord& record, const std::string& reason) {
    return {none(record.search.nodes.size(), reason, true), none(record.search.proposals.size(), reason, true)};
  }

  // All seeds together
  // -------------------------------------------------------------------------------------------------

  /// What the pool takes from the run of one seed, lifted to the root's space.
  struct PooledRun {
    const LevelRecord* record = nullptr;  ///< nullptr: the run did not reach the level
    Configurations nodes;
    Configurations proposals;
  };

  [[nodiscard]] std::vector<PooledRun> pooled_runs(std::size_t strategy, const std::string& key) const {
    std::vector<PooledRun> runs(seeds_);
    for (std::size_t seed = 0; seed < seeds_; ++seed) {
      const RunResult& one = run(strategy, seed);
      const auto level = std::find_if(one.levels.begin(), one.levels.end(),
                                      [&](const LevelResult& candidate) { return candidate.record.key == key; });
      if (level == one.levels.end()) continue;
      const LevelRecord& record = level->record;
      const auto some = [&](const Configurations& rows, const char* name) {
        return thinned(rows, pooled_samples, Stream(measure_seed + one.seed, key, name));
      };
      runs[seed] = {&record, some(nodes_of(record, record.root_nodes()), "pooled nodes"),
                    some(expansion(record, record.root_proposals()), "pooled proposals")};
    }
    return runs;
  }

  /// Returns the nodes of all runs but one, or the proposals with their density if all runs record it.
  [[nodiscard]] Sets pooled_sets(const Space& root, const std::vector<PooledRun>& runs, std::size_t without,
                                 bool tree) const {
    const LevelRecord* first = nullptr;
    Configurations nodes(root.dimension());
    Configurations proposals(root.dimension());
    std::vector<std::pair<double, const LevelRecord*>> known;
    bool closed = true;
    double total = 0.0;
    for (std::size_t seed = 0; seed < seeds_; ++seed) {
      const PooledRun& one = runs[seed];
      if (seed == without || one.record == nullptr) continue;
      if (first == nullptr) first = one.record;
      for (std::size_t i = 0; tree && i < one.nodes.size(); ++i) nodes.push(one.nodes[i]);
      if (tree) continue;
      for (std::size_t i = 0; i < one.proposals.size(); ++i) proposals.push(one.proposals[i]);
      if (one.proposals.empty()) continue;
      // The weight of a run is its number of samples in the pool.
      const auto weight = static_cast<double>(one.proposals.size());
      closed = closed && one.record->root_proposal_density;
      known.emplace_back(weight, one.record);
      total += weight;
    }
    const bool at_root = first != nullptr && first->level == 0;
    Sets sets{.tree = {root, nodes},
              .expansion = {root, proposals},
              .support = at_root ? sample_support(*first) : SampleSupport::anything,
              .brief = !at_root};
    if (closed && !known.empty()) {
      sets.density = [known, total](View x) {
        double sum = 0.0;
        for (const auto& [weight, record] : known) sum += weight * record->root_proposal_density(x);
        return sum / total;
      };
    }
    return sets;
  }

  /// Returns the keys of the levels that the runs of a strategy reached.
  [[nodiscard]] std::vector<std::string> level_keys(std::size_t strategy) const {
    std::vector<std::string> keys;
    for (std::size_t seed = 0; seed < seeds_; ++seed) {
      for (const LevelResult& level : run(strategy, seed).levels) {
        if (std::find(keys.begin(), keys.end(), level.record.key) == keys.end()) keys.push_back(level.record.key);
      }
    }
    return keys;
  }

  /// One path of each of some seeds, from any strategy that found one.
  [[nodiscard]] std::vector<std::size_t> pool_donors() const {
    std::vector<std::size_t> donors;
    std::vector<char> taken(seeds_, 0);
    for (const std::size_t strategy : by_name()) {
      for (std::size_t seed = 0; seed < seeds_; ++seed) {
        if (donors.size() == static_cast<std::size_t>(measure_.cross)) break;
        const std::size_t i = strategy * seeds_ + seed;
        if (!root_targets_[i] || !root_targets_[i]->target || taken[seed] != 0) continue;
        taken[seed] = 1;
        donors.push_back(i);
      }
    }
    return donors;
  }

  /// Scores the samples of all seeds of each level, appended.
  void score_pooled(std::vector<PooledScores>& pooled) {
    struct OfLevel {
      std::size_t strategy;
      std::string key;
      std::vector<PooledRun> runs;
      std::vector<Efficiency> tree, expansion;  // of each donor
    };
    const std::vector<std::size_t> donors = users_ || !crosses() ? std::vector<std::size_t>() : pool_donors();
    std::vector<OfLevel> levels;
    for (std::size_t s = 0; s < strategies_ && !donors.empty(); ++s) {
      if (!gives_paths(s)) continue;
      for (const std::string& key : level_keys(s)) {
        levels.push_back({s, key, pooled_runs(s, key), std::vector<Efficiency>(donors.size()),
                          std::vector<Efficiency>(donors.size())});
      }
    }
    const auto score_role = [&](OfLevel& level, std::size_t donor, bool tree) {
      poll();
      const Target& target = *root_targets_[donors[donor]]->target;
      const Sets sets = pooled_sets(target.space(), level.runs, donors[donor] % seeds_, tree);
      const Effort effort{.brief = sets.brief, .few_points = true, .pooled = true};
      (tree ? level.tree : level.expansion)[donor] =
          tree ? figure(target, sets.tree, sets.support, {}, effort)
               : figure(target, sets.expansion, SampleSupport::anything, sets.density, effort);
    };
    // Only one thread at a time may call the densities of a run.
    const std::size_t trees = levels.size() * donors.size();
    in_parallel(trees + strategies_, jobs_, [&](std::size_t i) {
      const PollScope polled(polled_);
      if (i < trees) {
        score_role(levels[i / donors.size()], i % donors.size(), true);
        return;
      }
      for (OfLevel& level : levels) {
        for (std::size_t donor = 0; donor < donors.size() && level.strategy == i - trees; ++donor) {
          score_role(level, donor, false);
        }
      }
    });
    std::vector<PooledScores> found;
    for (const OfLevel& level : levels) {
      const bool any = std::any_of(level.runs.begin(), level.runs.end(),
                                   [](const PooledRun& one) { return one.nodes.size() + one.proposals.size() > 0; });
      if (!any) continue;
      found.push_back({.problem = runs_.front()->problem,
                       .strategy = run(level.strategy, 0).strategy,
                       .key = level.key,
                       .seeds = seeds_ - 1,
                       .targets = donors.size(),
                       .scores = {mean(level.tree), mean(level.expansion)}});
    }
    pool_hitting(found, donors);
    if (store_ != nullptr) store_->pooled(runs_.front()->problem, found);
    std::move(found.begin(), found.end(), std::back_inserter(pooled));
  }

  // Hitting ----------------------------------------------------------------------------------------------------------

  /// Whether samples are scored in balls along paths, whose radius is that of the tube.
  [[nodiscard]] bool hits() const { return std::holds_alternative<TubeSettings>(measure_.target); }

  /// Returns the balls along the path of a run, which has one.
  [[nodiscard]] const PathBalls& balls(std::size_t index) {
    std::call_once(balls_made_[index], [&] {
      const LevelRecord& root = runs_[index]->levels.front().record;
      balls_[index] = std::make_unique<const PathBalls>(root.space, runs_[index]->run.path, root.position_axes,
                                                        common_settings(measure_.target).delta);
    });
    return *balls_[index];
  }

  /// Returns the runs whose paths score a strategy's samples of one seed: its own runs with the next seeds, because a
  /// guide may lead along another path than other guides do; without any, the runs that score all strategies.
  [[nodiscard]] std::vector<std::size_t> hit_donors(std::size_t strategy, std::size_t seed) const {
    std::vector<std::size_t> donors;
    for (std::size_t k = 1; k < seeds_ && donors.size() < static_cast<std::size_t>(measure_.cross); ++k) {
      const std::size_t other = strategy * seeds_ + (seed + k) % seeds_;
      if (has_path(*runs_[other])) donors.push_back(other);
    }
    return donors.empty() ? donors_[seed] : donors;
  }

  /// A level's samples in the root's space for hitting: at most so many of a run, chosen by chance.
  [[nodiscard]] static Configurations hitting_rows(const RunResult& run, const LevelRecord& record, bool tree,
                                                   std::size_t most) {
    const Stream some(measure_seed + run.seed, record.key, tree ? "hitting nodes" : "hitting proposals");
    return thinned(tree ? nodes_of(record, record.root_nodes()) : expansion(record, record.root_proposals()), most,
                   some);
  }

  /// Scores a level's samples of one run: on its own path, and on those of other seeds.
  void score_hitting(std::size_t index, LevelResult& level) {
    if (!hits()) return;
    const RunResult& result = *runs_[index];
    const View goal = result.levels.front().record.goal;
    const std::vector<std::size_t> donors =
        crosses() ? hit_donors(index / seeds_, index % seeds_) : std::vector<std::size_t>();
    for (const bool tree : {true, false}) {
      Efficiency Scores::*const role = tree ? &Scores::tree : &Scores::expansion;
      const bool own = level.root && has_path(result);
      const bool cross = level.root_cross && !donors.empty();
      if (!own && !cross) continue;
      const Configurations rows = hitting_rows(result, level.record, tree, hitting_samples);
      if (rows.empty()) continue;
      if (own) ((*level.root).*role).hitting = balls(index).hitting(rows, goal);
      if (!cross) continue;
      std::vector<Hitting> found;
      found.reserve(donors.size());
      for (const std::size_t donor : donors) found.push_back(balls(donor).hitting(rows, goal, false));
      ((*level.root_cross).*role).hitting = mean(found);
    }
  }

  /// A level's samples of all seeds, for hitting.
  struct HittingPool {
    std::size_t strategy = 0;
    std::string key;
    bool tree = false;
    std::vector<std::size_t> donors = {};   ///< runs whose paths score it
    std::vector<Configurations> rows = {};  ///< of each seed, without those at the goal
    Hitting found = {};

    /// Returns the number of samples without those of one seed.
    [[nodiscard]] std::size_t without(std::size_t seed) const {
      std::size_t count = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) count += i == seed ? 0 : rows[i].size();
      return count;
    }
  };

  /// Collects the samples of a pool, and the paths that score it: of the strategy's own runs, else of any.
  void fill(HittingPool& pool, const std::vector<std::size_t>& others) const {
    for (std::size_t seed = 0; seed < seeds_; ++seed) {
      const std::size_t index = pool.strategy * seeds_ + seed;
      const RunResult& one = *runs_[index];
      if (has_path(one) && pool.donors.size() < static_cast<std::size_t>(measure_.cross)) pool.donors.push_back(index);
      const auto level = std::find_if(one.levels.begin(), one.levels.end(),
                                      [&](const LevelResult& candidate) { return candidate.record.key == pool.key; });
      Configurations& kept = pool.rows.emplace_back();
      if (level == one.levels.end()) continue;
      const Configuration& goal = one.levels.front().record.goal;
      const Configurations rows = hitting_rows(one, level->record, pool.tree, hitting_samples);
      kept = Configurations(rows.dimension());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!std::equal(goal.begin(), goal.end(), rows[i].begin(), rows[i].end())) kept.push(rows[i]);
      }
    }
    if (pool.donors.empty()) pool.donors = others;
  }

  /// Scores a pool: hitting by `equal` samples, the bottleneck by all.
  void score_pool(HittingPool& pool, std::size_t equal) {
    std::vector<Hitting> pooled;
    std::vector<std::vector<double>> position(seeds_);  // of the runs, on each path
    std::vector<std::vector<double>> full(seeds_);
    for (const std::size_t donor : pool.donors) {
      poll();
      const std::size_t without = donor % seeds_;
      Configurations all(runs_[donor]->levels.front().record.space.dimension());
      for (std::size_t seed = 0; seed < seeds_; ++seed) {
        if (seed == without || pool.rows[seed].empty()) continue;
        for (std::size_t i = 0; i < pool.rows[seed].size(); ++i) all.push(std::as_const(pool.rows[seed])[i]);
        // Single runs have their share of the equal number, too.
        const Stream some(measure_seed + seed, pool.key, "hitting of a run");
        const Hitting run = balls(donor).hitting(
            thinned(pool.rows[seed], std::max<std::size_t>(1, equal / (seeds_ - 1)), some), {}, false);
        position[seed].push_back(run.position.hitting);
        full[seed].push_back(run.full.hitting);
      }
      if (all.empty()) continue;
      Hitting hitting = balls(donor).hitting(all, {}, pooled.empty());
      const Hitting by_equal =
          balls(donor).hitting(thinned(all, equal, Stream(measure_seed, pool.key, "hitting of all")), {}, false);
      hitting.position.hitting = by_equal.position.hitting;
      hitting.full.hitting = by_equal.full.hitting;
      hitting.samples = by_equal.samples;
      pooled.push_back(hitting);
    }
    pool.found = mean(pooled);
    const auto over_runs = [](const std::vector<std::vector<double>>& runs, BallHits& hits) {
      std::vector<double> values;
      for (const std::vector<double>& one : runs) {
        if (!one.empty())
          values.push_back(std::accumulate(one.begin(), one.end(), 0.0) / static_cast<double>(one.size()));
      }
      const Interval interval = student_interval(values);
      hits.hitting_lo = hits.hitting - 0.5 * (interval.hi - interval.lo);
      hits.hitting_hi = hits.hitting + 0.5 * (interval.hi - interval.lo);
    };
    over_runs(position, pool.found.position);
    over_runs(full, pool.found.full);
  }

  /// Scores the samples of all seeds of each level in balls along paths, all strategies' by as many samples.
  void pool_hitting(std::vector<PooledScores>& pooled, const std::vector<std::size_t>& others) {
    if (!hits() || pooled.empty()) return;
    std::vector<HittingPool> pools;
    std::vector<Efficiency*> to;
    for (PooledScores& one : pooled) {
      std::size_t strategy = 0;
      while (run(strategy, 0).strategy != one.strategy) ++strategy;
      for (const bool tree : {true, false}) {
        pools.push_back({.strategy = strategy, .key = one.key, .tree = tree});
        to.push_back(tree ? &one.scores.tree : &one.scores.expansion);
      }
    }
    in_parallel(pools.size(), jobs_, [&](std::size_t i) {
      const PollScope polled(polled_);
      fill(pools[i], others);
    });
    std::array<std::size_t, 2> equal = {most_hitting, most_hitting};  // of proposals, of nodes
    const std::string& root =
        runs_.front()->levels.empty() ? std::string("0") : runs_.front()->levels.front().record.key;
    for (const HittingPool& pool : pools) {
      if (pool.key != root) continue;
      for (const std::size_t donor : pool.donors) {
        const std::size_t count = pool.without(donor % seeds_);
        std::size_t& least = equal[pool.tree ? 1 : 0];
        if (count > 0) least = std::min(least, std::max(count, least_hitting));
      }
    }
    in_parallel(pools.size(), jobs_, [&](std::size_t i) {
      const PollScope polled(polled_);
      score_pool(pools[i], equal[pools[i].tree ? 1 : 0]);
    });
    for (std::size_t i = 0; i < pools.size(); ++i) to[i]->hitting = pools[i].found;
  }

  // Equal numbers ----------------------------------------------------------------------------------------------------

  static double measured_nodes(const Search& search) {
    const auto& validated = search.validated;
    return static_cast<double>(validated.empty()
                                   ? search.nodes.size()
                                   : static_cast<std::size_t>(std::count(validated.begin(), validated.end(), 1)));
  }
  static double measured_proposals(const Search& search) {
    return search.expands ? static_cast<double>(search.proposals.size()) : 0.0;
  }

  void choose_equal_number() {
    for (const bool tree : {true, false}) {
      double least = std::numeric_limits<double>::infinity();
      double most = 0.0;
      for (std::size_t s = 0; s < strategies_; ++s) {
        std::vector<double> numbers;
        for (std::size_t seed = 0; seed < seeds_; ++seed) {
          const auto& levels = run(s, seed).levels;
          if (levels.empty()) continue;
          const Search& search = levels.front().record.search;
          numbers.push_back(tree ? measured_nodes(search) : measured_proposals(search));
        }
        const double number = median(numbers);
        if (!(number > 0.0)) continue;
        least = std::min(least, number);
        most = std::max(most, number);
      }
      std::size_t& equal = tree ? equal_nodes_ : equal_proposals_;
      equal = most > much_different * least ? static_cast<std::size_t>(least) : 0;
    }
  }

  [[nodiscard]] static Configurations thinned(const Configurations& rows, std::size_t count, Stream stream) {
    if (rows.size() <= count) return rows;
    std::vector<std::uint32_t> ids(rows.size());
    std::iota(ids.begin(), ids.end(), 0U);
    Configurations chosen(rows.dimension());
    chosen.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto rest = static_cast<double>(ids.size() - i);
      std::swap(ids[i], ids[i + std::min(ids.size() - i - 1, static_cast<std::size_t>(stream.uniform() * rest))]);
      chosen.push(rows[ids[i]]);
    }
    return chosen;
  }

  void score_equal_number(LevelResult& level, const MadeTarget& root, std::vector<TargetPointer> targets) const {
    if (equal_nodes_ == 0 && equal_proposals_ == 0) return;
    if (targets.empty() && root.target) targets.push_back(root.target);
    const LevelRecord& record = level.record;
    const Configurations nodes =
        thinned(nodes_of(record, record.root_nodes()), equal_nodes_, Stream(measure_seed, record.key, "equal nodes"));
    const Configurations proposals = thinned(expansion(record, record.root_proposals()), equal_proposals_,
                                             Stream(measure_seed, record.key, "equal proposals"));
    // The recorded density does not depend on the number of samples: only estimates do.
    const Sets sets{.tree = {record.space, nodes},
                    .expansion = {record.space, proposals},
                    .support = sample_support(record),
                    .density = {},
                    .nodes = nodes,
                    .proposals = proposals};
    level.equal = mean_scores(targets, [&](const Target& target) {
      Scores found;
      tell("node", sets.nodes);
      const Effort effort{.brief = true, .few_points = true};
      if (equal_nodes_ > 0) found.tree = figure(target, sets.tree, sets.support, {}, effort);
      tell("proposal", sets.proposals);
      if (equal_proposals_ > 0) {
        found.expansion = figure(target, sets.expansion, SampleSupport::anything, {}, effort);
      }
      return found;
    });
  }

  const Experiment& experiment_;
  const Measure& measure_;
  std::vector<RunResult*> runs_;  // by strategy, seed
  unsigned jobs_;
  const std::function<void()>& progress_;
  const std::function<bool()>& interrupted_;
  const std::function<void()> polled_ = [this] { poll(); };  ///< by the loops of targets and estimators
  RunStore* store_;
  std::size_t seeds_;
  std::size_t strategies_;
  bool overview_;                                        // computes the scores of the overview only
  std::vector<std::optional<MadeTarget>> root_targets_;  // of each run; empty unless it is a donor
  std::vector<std::vector<MadeTarget>> level_targets_;   // of each run's levels; empty unless `cross_levels`
  std::vector<std::vector<std::size_t>> donors_;         // of each seed
  std::size_t equal_nodes_ = 0;                          // 0: not computed
  std::size_t equal_proposals_ = 0;
  std::vector<std::unique_ptr<const PathBalls>> balls_;  // of each run; made where they score
  std::vector<std::once_flag> balls_made_;
  bool users_;            // the target is a script's
  bool headline_only_;    // no other estimator is requested
  bool rough_intervals_;  // of single runs: reports print the pooled ones first
  bool together_;         // the overview prints pooled figures
  std::shared_ptr<UserTarget::ScoredSamples> scored_ = std::make_shared<UserTarget::ScoredSamples>();
};

}  // namespace

void score(const Experiment& experiment, ExperimentResult& result, unsigned jobs, const std::function<void()>& progress,
           const std::function<bool()>& interrupted, ScoreScope scope, RunStore* store) {
  const std::size_t each = experiment.strategies.size() * experiment.seeds.size();
  for (std::size_t problem = 0; problem < experiment.problems.size(); ++problem) {
    std::vector<RunResult*> runs(each);
    for (std::size_t i = 0; i < each; ++i) runs[i] = &result.runs[problem * each + i];
    ProblemScoring(experiment, runs, jobs, progress, interrupted, scope, store).score(result.pooled);
  }
}

}  // namespace trellis
