// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/scoring.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>

#include <trellis/base/parallel.hpp>
#include <trellis/experiment/targets.hpp>

namespace trellis {

namespace {

// A run is scored on several paths of others: with fewer points each, as their errors average out.
constexpr std::int64_t cross_points = 1024;
constexpr std::int64_t cross_pool = 4096;
constexpr std::size_t kept_points = 2048;  // of each run's target, for who draws it
// Numbers of samples within this factor of each other are compared as they are.
constexpr double much_different = 2.0;

using TargetPointer = std::shared_ptr<const Target>;

/// The functions of one run share its checkers, which serve one thread at a time; targets are shared between threads.
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

/// A figure that says why there is none.
Efficiency none(std::size_t samples, const std::string& reason, bool empty_target) {
  Efficiency figure;
  figure.samples = samples;
  figure.reason = reason;
  if (empty_target) figure.flags = {"empty target"};
  return figure;
}

/// The paths that a tube of another run can be laid around.
struct Donor {
  const LevelResult* level = nullptr;
  const Configurations* path = nullptr;
  std::uint64_t seed = 0;
};

class ProblemScoring {
 public:
  ProblemScoring(const Experiment& experiment, std::vector<RunResult*> runs, unsigned jobs,
                 const std::function<void()>& progress, const std::function<bool()>& interrupted)
      : experiment_(experiment),
        measure_(*experiment.measure),
        runs_(std::move(runs)),
        // A script's own functions run in the thread that owns its interpreter.
        jobs_(std::holds_alternative<UserTarget>(measure_.target) ? 1 : jobs),
        progress_(progress),
        interrupted_(interrupted),
        seeds_(experiment.seeds.size()),
        strategies_(experiment.strategies.size()) {
    const auto problem = std::find_if(experiment.problems.begin(), experiment.problems.end(),
                                      [&](const Problem& p) { return p.name == runs_.front()->problem; });
    occasion_->problem = &*problem;
  }

  void score() {
    for (RunResult* run : runs_) guard(*run);
    choose_equal_number();
    make_cross_targets();
    in_parallel(runs_.size(), jobs_, [&](std::size_t i) {
      score_run(i);
      progress_();
    });
  }

 private:
  [[nodiscard]] RunResult& run(std::size_t strategy, std::size_t seed) const {
    return *runs_[strategy * seeds_ + seed];
  }
  void poll() const {
    if (interrupted_()) throw Interrupted();
  }

  // Targets ----------------------------------------------------------------------------------------------------------

  /// The target that a run's path makes for a level; the root's is the path that the run reports.
  [[nodiscard]] MadeTarget own_target(const RunResult& run, const LevelResult& level, bool cross) const {
    const LevelRecord& record = level.record;
    const bool root = record.level == 0;
    const bool solved = root ? run.run.solved : record.solution.solved();
    const Configurations& path = root ? run.run.path : record.solution.path;
    if (const auto* settings = std::get_if<NearOptimalSettings>(&measure_.target)) {
      return cross ? MadeTarget{} : make_near_optimal(record, *settings);
    }
    if (!solved || path.empty()) return {nullptr, "no path of its own"};
    if (const auto* settings = std::get_if<TubeSettings>(&measure_.target)) {
      TubeSettings tube = *settings;
      if (cross) {
        tube.points = std::min(tube.points, cross_points);
        tube.pool = std::min(tube.pool, cross_pool);
      }
      return make_tube(record, path, tube, measure_seed + run.seed);
    }
    if (const auto* user = std::get_if<UserTarget>(&measure_.target); user != nullptr && root) {
      const auto draws = cross ? cross_pool : std::max(user->pool, user->points);
      const Problem& problem = *occasion_->problem;
      *occasion_ = {&problem, run.strategy, run.seed, "", "", nullptr};
      return {std::make_shared<const Target>(Target::distribution(
                  record.space, *user, user->make({problem, path, draws, measure_seed + run.seed, occasion_}))),
              ""};
    }
    return {nullptr, "the target lies in the root's space"};
  }

  /// Whether a strategy's paths serve the others: those with a guide taken out would change what the whole ones are
  /// scored on.
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

  /// For each seed the runs whose paths all strategies are scored on: those of the next seeds, the strategies taking
  /// turns.
  void choose_donors() {
    std::vector<std::size_t> givers;
    for (std::size_t s = 0; s < strategies_; ++s) {
      if (gives_paths(s)) givers.push_back(s);
    }
    const auto wanted = static_cast<std::size_t>(measure_.cross);
    donors_.resize(seeds_);
    for (std::size_t seed = 0; seed < seeds_; ++seed) {
      for (std::size_t lap = 0; lap < givers.size() && donors_[seed].size() < wanted; ++lap) {
        for (std::size_t k = 1; k < seeds_ && donors_[seed].size() < wanted; ++k) {
          const std::size_t other = (seed + k) % seeds_;
          // The strategy whose turn it is, or the next one that found a path under this seed.
          for (std::size_t turn = 0; turn < givers.size(); ++turn) {
            const std::size_t index = givers[(other + k + lap + turn) % givers.size()] * seeds_ + other;
            const bool taken = std::find(donors_[seed].begin(), donors_[seed].end(), index) != donors_[seed].end();
            if (taken || !cross_roots_[index]) continue;
            donors_[seed].push_back(index);
            break;
          }
        }
      }
    }
  }

  void make_cross_targets() {
    cross_roots_.resize(runs_.size());
    cross_levels_.resize(runs_.size());
    if (!crosses()) {
      donors_.resize(seeds_);
      return;
    }
    in_parallel(runs_.size(), jobs_, [&](std::size_t i) {
      poll();
      const RunResult& result = *runs_[i];
      cross_levels_[i].resize(result.levels.size());
      for (std::size_t l = 0; l < result.levels.size(); ++l) {
        cross_levels_[i][l] = own_target(result, result.levels[l], true).target;
      }
      if (!result.levels.empty()) cross_roots_[i] = cross_levels_[i].front();
    });
    choose_donors();
  }

  /// The targets of the same level under other seeds.
  [[nodiscard]] std::vector<TargetPointer> level_targets(std::size_t index, const LevelRecord& record) const {
    std::vector<TargetPointer> targets;
    const std::size_t strategy = index / seeds_;
    const std::size_t seed = index % seeds_;
    for (std::size_t k = 1; k < seeds_ && targets.size() < static_cast<std::size_t>(measure_.cross); ++k) {
      const std::size_t other = strategy * seeds_ + (seed + k) % seeds_;
      const auto& levels = runs_[other]->levels;
      for (std::size_t l = 0; l < cross_levels_[other].size(); ++l) {
        if (levels[l].record.key == record.key && cross_levels_[other][l] && levels[l].record.space == record.space) {
          targets.push_back(cross_levels_[other][l]);
        }
      }
    }
    return targets;
  }

  // Scoring ----------------------------------------------------------------------------------------------------------

  [[nodiscard]] Efficiency figure(const char* role, const Target& target, const Configurations& samples, Held held,
                                  const std::function<double(View)>& density) const {
    poll();
    if (std::holds_alternative<UserTarget>(measure_.target)) {
      occasion_->role = role;
      occasion_->samples = &samples;
    }
    if (samples.empty()) {
      Efficiency result = none(0, "there are no samples", false);
      result.uniform = target.uniform();
      result.free_share = target.free_share();
      return result;
    }
    return efficiency(target, samples,
                      {.held = held, .estimators = measure_.estimators, .density = density, .points = 0});
  }

  [[nodiscard]] Scores own_scores(const Target& target, const LevelRecord& record) const {
    return {figure("node", target, record.search.tree_samples(record.search.nodes), held(record), {}),
            expansion(target, record, record.search.proposals, record.proposal_density)};
  }
  [[nodiscard]] Scores root_scores(const RunResult& run, const Target& target, const LevelRecord& record) const {
    tell(run, record);
    // What entered a tree was found valid in the level's own space; lifted to the root it may be anything again.
    return {figure("node", target, record.search.tree_samples(record.root_nodes),
                   record.level == 0 ? held(record) : Held::anything, {}),
            expansion(target, record, record.root_proposals, record.root_proposal_density)};
  }

  /// Says whose samples are being scored. A script's functions run in one thread, and nobody else asks.
  void tell(const RunResult& run, const LevelRecord& record) const {
    if (!std::holds_alternative<UserTarget>(measure_.target)) return;
    occasion_->strategy = run.strategy;
    occasion_->seed = run.seed;
    occasion_->level =
        level_path(record, [&](int i) -> const LevelRecord& { return run.levels[static_cast<std::size_t>(i)].record; });
  }

  [[nodiscard]] Efficiency expansion(const Target& target, const LevelRecord& record, const Configurations& rows,
                                     const std::function<double(View)>& density) const {
    if (!record.search.expands) return figure("proposal", target, Configurations(rows.dimension()), Held::anything, {});
    return figure("proposal", target, rows, Held::anything, density);
  }

  static Held held(const LevelRecord& record) {
    return find_planner(record.planner)->unverified ? Held::anything : Held::valid_only;
  }

  template <class Score>
  static std::optional<Scores> mean_scores(const std::vector<TargetPointer>& targets, Score score) {
    if (targets.empty()) return std::nullopt;
    std::vector<Efficiency> tree;
    std::vector<Efficiency> expansion;
    for (const auto& target : targets) {
      Scores scores = score(*target);
      tree.push_back(std::move(scores.tree));
      expansion.push_back(std::move(scores.expansion));
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

  void score_paths(std::size_t index, RunResult& result) {
    const MadeTarget root = own_target(result, result.levels.front(), false);
    std::vector<TargetPointer> crossing;
    for (const std::size_t donor : donors_[index % seeds_]) crossing.push_back(cross_roots_[donor]);
    if (root.target) keep(*root.target, result.target);
    for (LevelResult& level : result.levels) {
      const LevelRecord& record = level.record;
      if (root.target) {
        level.root = root_scores(result, *root.target, record);
      } else if (result.run.solved) {
        level.root = absent(record, root.reason);
      }
      level.root_cross =
          mean_scores(crossing, [&](const Target& target) { return root_scores(result, target, record); });
      if (record.level == 0) {
        level.own = level.root;
        level.own_cross = level.root_cross;
      } else {
        const MadeTarget own = own_target(result, level, false);
        if (own.target) {
          level.own = own_scores(*own.target, record);
        } else if (record.solution.solved() && !std::holds_alternative<UserTarget>(measure_.target)) {
          level.own = absent(record, own.reason);
        }
        if (crosses()) {
          level.own_cross = mean_scores(level_targets(index, record),
                                        [&](const Target& target) { return own_scores(target, record); });
        }
      }
    }
    // A target that is the same for every run has no other seeds' version.
    if (std::holds_alternative<NearOptimalSettings>(measure_.target)) {
      for (LevelResult& level : result.levels) {
        level.own_cross = level.own;
        level.root_cross = level.root;
      }
    }
    tell(result, result.levels.front().record);
    score_equal_number(result.levels.front(), root, crossing);
  }

  /// Some of a target's points, spread as it is.
  static void keep(const Target& target, Configurations& kept) {
    const std::size_t count = std::min(target.pool().size(), kept_points);
    kept = Configurations(target.space().dimension());
    kept.reserve(count);
    for (std::size_t i = 0; i < count; ++i) kept.push(target.pool()[i]);
  }

  void score_progress(RunResult& result, const ProgressSettings& settings) const {
    for (LevelResult& level : result.levels) {
      Scores scores;
      for (const bool tree : {true, false}) {
        const Ranks ranks = rank_motions(level.record, tree, settings, measure_seed + result.seed);
        Efficiency& role = tree ? scores.tree : scores.expansion;
        role = ranks.target.target ? figure("motion", *ranks.target.target, ranks.samples, Held::anything, {})
                                   : none(ranks.samples.size(), ranks.target.reason, false);
      }
      level.own = scores;
      level.own_cross = scores;
      // Motions are not lifted: only the root's own are in the root's space.
      if (level.record.level == 0) {
        level.root = scores;
        level.root_cross = scores;
      }
    }
  }

  static Scores absent(const LevelRecord& record, const std::string& reason) {
    return {none(record.search.nodes.size(), reason, true), none(record.search.proposals.size(), reason, true)};
  }

  // Equal numbers ----------------------------------------------------------------------------------------------------

  static double measured_nodes(const Search& search) {
    const auto& looked_at = search.looked_at;
    return static_cast<double>(looked_at.empty()
                                   ? search.nodes.size()
                                   : static_cast<std::size_t>(std::count(looked_at.begin(), looked_at.end(), 1)));
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
    const Configurations nodes = thinned(record.search.tree_samples(record.root_nodes), equal_nodes_,
                                         Stream(measure_seed, record.key, "equal nodes"));
    const Configurations proposals =
        thinned(record.root_proposals, equal_proposals_, Stream(measure_seed, record.key, "equal proposals"));
    level.equal = mean_scores(targets, [&](const Target& target) {
      Scores scores;
      if (equal_nodes_ > 0) scores.tree = figure("node", target, nodes, held(record), {});
      // The density is known whatever the number of samples: only estimates depend on it.
      if (equal_proposals_ > 0) scores.expansion = expansion(target, record, proposals, {});
      return scores;
    });
  }

  const Experiment& experiment_;
  const Measure& measure_;
  std::vector<RunResult*> runs_;  // by strategy, seed
  unsigned jobs_;
  const std::function<void()>& progress_;
  const std::function<bool()>& interrupted_;
  std::size_t seeds_;
  std::size_t strategies_;
  std::vector<TargetPointer> cross_roots_;                // of each run
  std::vector<std::vector<TargetPointer>> cross_levels_;  // of each run's levels
  std::vector<std::vector<std::size_t>> donors_;          // of each seed
  std::size_t equal_nodes_ = 0;                           // 0: not wanted
  std::size_t equal_proposals_ = 0;
  std::shared_ptr<UserTarget::Occasion> occasion_ = std::make_shared<UserTarget::Occasion>();
};

}  // namespace

void score(const Experiment& experiment, ExperimentResult& result, unsigned jobs, const std::function<void()>& progress,
           const std::function<bool()>& interrupted) {
  const std::size_t each = experiment.strategies.size() * experiment.seeds.size();
  for (std::size_t problem = 0; problem < experiment.problems.size(); ++problem) {
    std::vector<RunResult*> runs;
    for (std::size_t i = 0; i < each; ++i) runs.push_back(&result.runs[problem * each + i]);
    ProblemScoring(experiment, std::move(runs), jobs, progress, interrupted).score();
  }
}

}  // namespace trellis
