// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/executor.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/helper_threads.hpp>
#include <trellis/base/lua_time.hpp>
#include <trellis/base/slice_monitor.hpp>
#include <trellis/instance/search_cost.hpp>
#include <trellis/scene/set_up_cache.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/companion.hpp>
#include <trellis/strategy/scale.hpp>

namespace trellis {

namespace {

/// Whether the guide of a level searches another level, directly or further below. The halves of a divided level are
/// below it too: the last number of a half's key is that of its try, from 1; a guide's begins with 0.
bool searched_by_guide_of(const LevelRecord& above, const LevelRecord& level) {
  return level.key.starts_with(above.key + "/0");
}

/// Whether a level is a half of a divided level. The record of the divided level contains its proposals.
bool is_half(const LevelRecord& level) {
  const std::size_t last = level.key.rfind('/');
  return last != std::string::npos && level.key[last + 1] != '0';
}

void add_spent_below(std::vector<LevelRecord>& levels) {
  for (LevelRecord& above : levels) {
    for (const LevelRecord& level : levels) {
      if (!searched_by_guide_of(above, level)) continue;
      above.checks_below += level.search.checks.validity;
      if (!is_half(level)) above.proposals_below += level.search.proposals.size();
    }
  }
}

}  // namespace

std::string level_path(const LevelRecord& level, const std::function<const LevelRecord&(int)>& at) {
  std::string path;
  const LevelRecord* record = &level;
  while (record->parent >= 0) {
    path += record->name + " >> ";
    record = &at(record->parent);
  }
  return fmt::format("{}{}, level {}", path, record->planner, level.level);
}

namespace {

/// Whether a time has passed. Reads the clock at one of eight calls where those follow each other within microseconds:
/// reading it takes 3 % of the time of an arm's steps.
class Deadline {
 public:
  explicit Deadline(double seconds) : seconds_(seconds) {}
  /// \param elapsed  returns the seconds so far
  template <class Elapsed>
  bool passed(const Elapsed& elapsed) {
    if (skipped_ > 0) {
      --skipped_;
      return false;
    }
    constexpr int every = 8;
    constexpr double short_time = 1e-4;
    const double now = elapsed();
    if (now >= seconds_) return true;
    if (now - last_ < short_time) skipped_ = every - 1;
    last_ = now;
    return false;
  }

 private:
  double seconds_;
  double last_ = -1.0;
  int skipped_ = 0;
};

/// Checks that the cost of a search is finite and has not decreased: otherwise bounded loss would hold by accident.
/// \param step  difference to its cost before
void check_growth(const RunCost& step, const RunCost& cost) {
  // Sums of work are rounded.
  constexpr double rounding = 1e-9;
  const auto grows = [](double difference, double sum) {
    return std::isfinite(sum) && difference >= -rounding * std::abs(sum);
  };
  if (grows(step.checks, cost.checks) && grows(step.work, cost.work)) return;
  throw Fault(
      fmt::format("a step of the guided search has cost {} checks and {} units of work", step.checks, step.work));
}

/// Restores what levels have counted, when it ends: the record of a run that continues may search a graph and lift
/// configurations, which is no part of the run.
class KeptCounts {
 public:
  explicit KeptCounts(std::vector<Level*> levels) : levels_(std::move(levels)) {
    for (Level* level : levels_) counts_.emplace_back(level->instance().checks, level->instance().lift_work.total());
  }
  ~KeptCounts() {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      levels_[i]->instance().checks = counts_[i].first;
      *levels_[i]->instance().lift_work.shared() = counts_[i].second;
    }
  }
  KeptCounts(const KeptCounts&) = delete;
  KeptCounts& operator=(const KeptCounts&) = delete;

 private:
  MonitorScope unmonitored_{nullptr};
  std::vector<Level*> levels_;
  std::vector<std::pair<Checks, double>> counts_;
};

/// A run, from its levels to its record.
class Running {
 public:
  Running(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed, const ExecuteOptions& options)
      : problem_(problem), options_(options) {
    check(problem);
    check_depth(strategy);
    check_scale(strategy, problem);
    begin_ = std::chrono::steady_clock::now();
    run_.cpu_begin = thread_seconds();
    run_.lua_begin = lua_seconds();
    run_.lua_depth = lua_depth();
    run_.problem = problem.name;
    run_.seed = seed;
    run_.seeded = true;
    run_.densities = options.measured;
    run_.interrupted = options.interrupted;
    if (options.work_limit > 0.0 || options.check_limit > 0) {
      run_.interrupted = [this] { return (options_.interrupted && options_.interrupted()) || reached(cost()); };
    }
    run_.watch = options.watch;
    if (options.threads > 1) run_.helpers = &helpers_.emplace(options.threads);
    root_.emplace(run_, strategy, problem);
    if (const double seconds = root_->level().common().budget.seconds; seconds < Budget::unlimited) {
      run_.out_of_time = [this, deadline = Deadline(seconds)]() mutable {
        return deadline.passed([this] { return elapsed(); });
      };
    }
    anytime_ = find_planner(strategy.planner().name())->component->find("improve") != nullptr;
    run_.clock.switch_to(&setup_);
    root_->level().heuristic().report_paths([this](double length) { note_improvement(run_, length); });
    if (strategy.guide() == nullptr) return;
    const PlannerCommon& common = root_->level().common();
    bound_ = options.companion ? common.bound : 0.0;
    run_.queries = common.queries;
    if (common.queries <= 1.0) own_set_ups_.emplace();
    const OwnSetUpsScope unshared(own_set_ups());
    guides_ = strategy.guide();
    if (bound_ > 0.0) {
      set_up_ = set_up_work(*guides_, *problem.scene, common.queries);
      root_->level().rely_on_companion();
      companion_.emplace(strategy, problem, run_);
      companion_->search().level().heuristic().report_paths(
          [this](double length) { note_improvement(companion_->run(), length); });
      run_.before_step = [this] { return companion_ends_run(); };
      run_.before_set_up = [this](double work) { return companion_ends_run_before(work); };
    }
    if (companion_) make_monitor();
    // Otherwise the companion goes first.
    if (set_up_ <= companion_constant.work) set_up();
  }

  /// Searches until a path is certified, or until no search is left.
  void search() {
    const OwnSetUpsScope unshared(own_set_ups());
    if (!run_.ending && (guides_ == nullptr || is_set_up_ || set_up_after_companion())) {
      const MonitorScope monitored(monitor());
      while (!root_->ended()) root_->step();
    }
    add_uncounted();
    note_step(run_.cost());
    if (companion_ && !root_->certified() && !run_interrupted()) {
      // What the unguided planner finds, a guided run finds too.
      constexpr double all = std::numeric_limits<double>::infinity();
      companion_->keep_up({all, all}, run_.clock);
      companion_decides_ = root_->status() == Status::interrupted || companion_->search().certified();
    } else if (run_.ending && companion_->search().certified()) {
      // Both have a path: an anytime planner improved its own.
      const Space& space = problem_.space;
      companion_decides_ = path_length(space, companion_->search().path()) <= path_length(space, root_->path());
    }
    ended_ = true;
    note_times();
  }

  /// The record so far. Once the search has ended, callable once.
  RunRecord record() {
    const OwnSetUpsScope unshared(own_set_ups());
    const KeptCounts kept(ended_ ? std::vector<Level*>() : all_levels());
    RunRecord record;
    RootSearch& decisive = companion_decides_ ? companion_->search() : *root_;
    record.solved = record.certified = decisive.certified();
    record.status = ended_ ? decisive.status() : Status::interrupted;
    record.seconds = seconds_;
    record.cpu_seconds = cpu_seconds_;
    record.lua_seconds = seconds_ > 0.0 ? cpu_seconds_ * std::min(1.0, lua_seconds_ / seconds_) : 0.0;
    for (RootSearch* search : searches()) record.refuted_paths += search->refuted_paths();
    for (Level* level : all_levels()) {
      record.validity_checks += level->instance().checks.validity;
      record.motion_checks += level->instance().checks.motion;
    }
    record.work = cost().work;
    if (is_set_up_) {
      constexpr double all = std::numeric_limits<double>::infinity();
      record.set_up = set_up_work(*guides_, *problem_.scene, 1.0);
      if (record.set_up > set_up_work(*guides_, *problem_.scene, all)) record.queries = run_.queries;
    }
    record.set_up_seconds = set_up_seconds_;
    if (record.solved) add_path(record, decisive);
    for (RootSearch* search : searches()) {
      record.path_checks += search->check_path().checks();
      record.path_seconds += search->check_path().cpu_seconds();
    }
    record.turns = run_.turns;
    record.conflicts = run_.conflicts;
    if (!ended_ && run_.active_level != nullptr) run_.active_level->add_open_turn(record.turns);
    if (companion_) add_companion(record);
    const Level* companion = companion_ ? &companion_->search().level() : nullptr;
    for (Level* level : run_.levels) {
      const Level* merged = level == &root_->level() ? companion : nullptr;
      record.levels.push_back(ended_ ? level->take_record(options_.measured, merged)
                                     : level->record_so_far(options_.measured, merged));
    }
    add_spent_below(record.levels);
    // The root's solution is the reported path.
    LevelRecord& root = record.levels.front();
    if (companion_decides_) {
      root.solution = companion_->search().level().solution();
      root.goal = companion_->search().level().record().goal;
    }
    if (record.solved) root.solution.path = record.path;
    record.improvements = run_.improvements;
    if (companion_) {
      const auto& beside = companion_->run().improvements;
      const bool decides = companion_decides_;
      record.improvements = decides ? improvements_of(beside, run_.improvements, record.solved)
                                    : improvements_of(run_.improvements, beside, record.solved);
    }
    // A path that was refuted as the run ended was none.
    if (!record.solved && record.status != Status::interrupted) record.improvements.clear();
    if (anytime_ && !record.improvements.empty()) {
      record.improvement_checks = record.validity_checks - record.improvements.front().validity_checks;
    }
    return record;
  }
  [[nodiscard]] const LevelRecord& level(std::size_t number) const { return run_.levels.at(number)->record(); }
  [[nodiscard]] const LevelRecord* companion() { return companion_ ? &companion_->search().level().record() : nullptr; }

  /// Called by the thread of the run before and after it waits: waiting counts for no level.
  void stopped() {
    note_times();
    stopped_at_ = std::chrono::steady_clock::now();
    account_ = run_.clock.switch_to(nullptr);
    if (companion_) companion_account_ = companion_->run().clock.switch_to(nullptr);
  }
  void continued() {
    const double waited = std::chrono::duration<double>(std::chrono::steady_clock::now() - stopped_at_).count();
    run_.clock.switch_to(account_);
    run_.stopped += waited;
    if (!companion_) return;
    companion_->run().clock.switch_to(companion_account_);
    companion_->run().stopped += waited;
  }

 private:
  /// nullptr: the run shares what its guides compute of worlds.
  [[nodiscard]] OwnSetUps* own_set_ups() { return own_set_ups_ ? &*own_set_ups_ : nullptr; }

  /// Called by the thread of the run: its CPU time is that thread's.
  void note_times() {
    seconds_ = elapsed();
    cpu_seconds_ = thread_seconds() - run_.cpu_begin + (helpers_ ? helpers_->cpu_seconds() : 0.0);
    lua_seconds_ = lua_seconds() - run_.lua_begin;
    for (RootSearch* search : searches()) {
      seconds_ -= std::chrono::duration<double>(search->check_path().time()).count();
      cpu_seconds_ -= search->check_path().cpu_seconds();
    }
  }

  /// Seconds since the beginning of the run, without those in which it waited.
  [[nodiscard]] double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() - run_.stopped;
  }
  /// Of all levels and the companion.
  [[nodiscard]] RunCost cost() const { return companion_ ? run_.cost() + companion_->cost() : run_.cost(); }
  /// Whether a cost reaches a limit of the run.
  [[nodiscard]] bool reached(const RunCost& cost) const {
    return (options_.work_limit > 0.0 && cost.work >= options_.work_limit) ||
           (options_.check_limit > 0 && cost.checks >= static_cast<double>(options_.check_limit));
  }
  [[nodiscard]] bool run_interrupted() const { return run_.interrupted && run_.interrupted(); }

  /// Makes the levels of the guides.
  void set_up() {
    allowed_ = {0.0, set_up_};
    run_.estimated_set_up = set_up_;
    const double before = elapsed();
    const MonitorScope monitored(monitor());
    try {
      root_->level().guide_by(*guides_);
      is_set_up_ = true;
    } catch (const SearchEnded&) {
      run_.abandons_levels = false;
    }
    run_.estimated_set_up = 0.0;
    set_up_seconds_ = elapsed() - before;
  }
  /// Lets the companion do as much work as the set-up costs, then makes the levels of the guides. Returns whether it
  /// did: not if the companion has ended before.
  bool set_up_after_companion() {
    companion_->keep_up(wanted({0.0, set_up_}), run_.clock);
    const bool out_of_time = run_.out_of_time && run_.out_of_time();
    if (run_interrupted() || out_of_time || companion_decides({0.0, set_up_})) return false;
    set_up();
    return is_set_up_;
  }
  /// The cost that the companion must have had before the guided search, which has cost so much, continues.
  [[nodiscard]] RunCost wanted(const RunCost& guided) const {
    const double share = 1.0 / (bound_ - 1.0);
    return {share * (guided.checks - companion_constant.checks), share * (guided.work - companion_constant.work)};
  }
  /// Whether the companion has ended, and with a path or before the guided search may continue.
  [[nodiscard]] bool companion_decides(const RunCost& guided) {
    const RootSearch& other = companion_->search();
    if (!other.ended() || other.certified()) return other.ended();
    const RunCost most = wanted(guided);
    const RunCost done = companion_->cost();
    return most.checks > done.checks || most.work > done.work;
  }

  /// Lets the companion catch up with the guided search, as if that had spent `more` already. Returns whether the run
  /// ends.
  /// \param guided  cost of the guided search
  bool companion_ends_run_before(const RunCost& more, const RunCost& guided) {
    if (run_.ending) return true;
    const RunCost most = guided + more;
    companion_->keep_up(wanted(most), run_.clock);
    run_.ending = companion_decides(most);
    if (!run_.ending) {
      note_step(guided);
      allowed_ = most;
    } else if (monitor_) {
      // Where levels still spend something while they end, SearchEnded ends them.
      monitor_->end();
    }
    return run_.ending;
  }
  /// Called before each step of the guided search. Returns whether the run ends.
  bool companion_ends_run() {
    if (run_.ending) return true;
    const RunCost uncounted = begin_slice();
    return companion_ends_run_before(uncounted, slice_begun_);
  }
  /// Called before a further set-up, which is no part of a step. Returns whether the run ends.
  bool companion_ends_run_before(double set_up) {
    const RunCost guided = run_.cost();
    return companion_ends_run_before(announced_only(guided) + RunCost{0.0, set_up}, guided);
  }

  void make_monitor() {
    const CheckCost& check = root_->level().instance().validity->cost();
    monitor_.emplace(SliceMonitor::CheckRates{check.on_motion, check.alone},
                     search_cost::proposal + search_cost::guided_proposal,
                     [this](const Spending& next) { return ask(next); });
  }
  [[nodiscard]] SliceMonitor* monitor() { return monitor_ ? &*monitor_ : nullptr; }
  /// Returns what was announced and not counted yet.
  RunCost begin_slice() {
    const RunCost guided = run_.cost();
    const RunCost uncounted = monitor_ ? announced_only(guided) : RunCost{};
    slice_begun_ = guided;
    unannounced_ = run_.unannounced_set_up;
    if (monitor_) monitor_->begin({uncounted.checks, uncounted.work});
    return uncounted;
  }
  /// Called within a step, before the guided search spends more than a slice (SliceMonitor::Ask).
  bool ask(const Spending& next) {
    // An exception would pass through the script.
    if (lua_depth() > run_.lua_depth) return false;
    const RunCost guided = run_.cost();
    const RunCost uncounted = announced_only(guided);
    RunCost more = uncounted + RunCost{std::max(0.0, next.checks - largest_slice.checks),
                                       std::max(0.0, next.work - largest_slice.work)};
    // All of the set-up was estimated before it began.
    if (!is_set_up_) more.work += std::max(0.0, set_up_ - run_.set_up);
    // The run is stopped between two proposals, of which the companion may have drawn the last one.
    if (!companion_ends_run_before(more, guided) && !run_interrupted()) return true;
    monitor_->end();
    uncounted_ = uncounted;
    run_.abandons_levels = true;
    // The account may belong to what ends now.
    run_.clock.switch_to(nullptr);
    throw SearchEnded{};
  }
  /// What the guided search has announced and not counted: a guide may count its checks after several of them.
  /// \param guided  its cost so far
  [[nodiscard]] RunCost announced_only(const RunCost& guided) const {
    const RunCost counted = guided - slice_begun_;
    const double set_up = run_.unannounced_set_up - unannounced_;
    return {std::max(0.0, monitor_->announced().checks - counted.checks),
            std::max(0.0, monitor_->announced().work - (counted.work - set_up))};
  }
  /// Adds what the search had spent and not counted when it was ended within a step.
  void add_uncounted() {
    Checks& checks = root_->level().instance().checks;
    checks.validity += static_cast<std::uint64_t>(uncounted_.checks);
    checks.other += uncounted_.work;
    uncounted_ = {};
  }

  /// Notes what the guided search has spent beyond what the companion allows.
  /// \param guided  cost of the guided search
  void note_step(const RunCost& guided) {
    check_growth(guided - guided_before_, guided);
    guided_before_ = guided;
    const RunCost step = guided - allowed_;
    largest_step_ = {std::max(largest_step_.checks, step.checks), std::max(largest_step_.work, step.work)};
  }

  std::vector<RootSearch*> searches() {
    std::vector<RootSearch*> all = {&*root_};
    if (companion_) all.push_back(&companion_->search());
    return all;
  }
  std::vector<Level*> all_levels() {
    std::vector<Level*> all = run_.levels;
    if (companion_) all.insert(all.end(), companion_->run().levels.begin(), companion_->run().levels.end());
    return all;
  }

  /// Records a path of one of the searches if it is shorter than its earlier ones.
  void note_improvement(Run& run, double length) {
    auto& improvements = run.improvements;
    // A path that was known before the refutation and is not longer than this one was not certified either.
    while (run.refuted && !improvements.empty() && improvements.back().length <= length) improvements.pop_back();
    run.refuted = false;
    if (!improvements.empty() && !(length < improvements.back().length)) return;
    std::uint64_t checks = 0;
    for (Level* level : all_levels()) checks += level->instance().checks.validity;
    improvements.push_back({checks, thread_seconds() - run_.cpu_begin, length});
  }

  /// Returns the improvements of a run whose two searches found paths: the first path is that of either.
  /// \param decided  the path of `decisive` is reported: none of the others is shorter in what is returned
  static std::vector<Improvement> improvements_of(const std::vector<Improvement>& decisive,
                                                  const std::vector<Improvement>& other, bool decided) {
    std::vector<Improvement> all = decisive;
    for (const Improvement& one : other) {
      if (!decided || decisive.empty() || one.length > decisive.back().length) all.push_back(one);
    }
    std::stable_sort(all.begin(), all.end(), [](const Improvement& a, const Improvement& b) {
      return std::pair(a.validity_checks, a.length) < std::pair(b.validity_checks, b.length);
    });
    std::vector<Improvement> shorter;
    for (const Improvement& one : all) {
      if (shorter.empty() || one.length < shorter.back().length) shorter.push_back(one);
    }
    return shorter;
  }

  void add_companion(RunRecord& record) {
    record.bounded = {.bound = bound_,
                      .constant = companion_constant,
                      .largest_step = largest_step_,
                      .guided = run_.cost(),
                      .unguided = companion_->cost(),
                      .set_up = is_set_up_ ? run_.set_up : set_up_,
                      .guides_set_up = is_set_up_,
                      .unguided_won = companion_decides_ && record.solved,
                      .unguided_proposals = companion_->search().level().record().search.proposals.size()};
    const Search& own = root_->level().record().search;
    const Search& other = companion_->search().level().record().search;
    if (other.nodes.empty()) return;
    const auto sum = [](std::size_t a, std::size_t b) { return static_cast<std::uint32_t>(a + b); };
    record.turns.push_back({0, sum(own.proposals.size(), other.proposals.size()),
                            sum(own.nodes.size(), other.nodes.size()), ended_, record.path});
  }

  void add_path(RunRecord& record, RootSearch& search) {
    record.path = search.path();
    record.trajectory = search.level().solution().trajectory;
    // Straight motions cannot shortcut a path with a motion model.
    if (options_.shortcut > 0 && !problem_.motion_model) {
      Checks& checks = search.level().instance().checks;
      const Checks planned = checks;
      Stream stream(run_.seed, "0", "shortcut");
      const auto certified = [&](const Configurations& part) { return !search.check_path().refuted(part); };
      record.path = search.check_path().divided(
          shortcut(search.level().instance(), record.path, options_.shortcut, stream, certified));
      // Its clearance, and a last look: parts of motions were certified one by one.
      if (search.check_path().refuted(record.path)) {
        record.path = search.path();
        static_cast<void>(search.check_path().refuted(record.path));
      }
      record.shortcut_checks = checks.validity - planned.validity;
      checks = planned;
    }
    record.length = path_length(problem_.space, record.path);
    const std::vector<TeamMember> members = problem_.scene->members();
    if (members.size() > 1) {
      const MotionModel* const model = problem_.motion_model.get();
      record.times = model != nullptr ? times_of_steps(members, record.path, model->dt())
                                      : times_of(problem_.space, members, record.path);
    }
    record.clearance = search.check_path().clearance();
  }

  const Problem& problem_;
  const ExecuteOptions& options_;
  std::chrono::steady_clock::time_point begin_;
  std::optional<HelperThreads> helpers_;
  std::optional<OwnSetUps> own_set_ups_;  ///< of a run that is the only one in its world
  Run run_;
  double setup_ = 0.0;
  double set_up_seconds_ = 0.0;
  bool anytime_ = false;  ///< the root's planner continues after its first path
  double bound_ = 0.0;
  const GuideSpec* guides_ = nullptr;
  double set_up_ = 0.0;  ///< estimated work of the set-up
  bool is_set_up_ = false;
  std::optional<RootSearch> root_;
  std::optional<Companion> companion_;
  std::optional<SliceMonitor> monitor_;  ///< of the guided search, beside a companion
  RunCost guided_before_;                ///< of the guided search when it was noted last
  RunCost allowed_;                      ///< cost of the guided search that the companion has kept up with
  RunCost slice_begun_;                  ///< cost of the guided search when the monitor began a slice
  double unannounced_ = 0.0;             ///< run_.unannounced_set_up then
  RunCost uncounted_;                    ///< of the guided search when it was ended within a step
  RunCost largest_step_;
  bool companion_decides_ = false;
  bool ended_ = false;
  double seconds_ = 0.0;
  double cpu_seconds_ = 0.0;
  double lua_seconds_ = 0.0;  ///< wall clock
  std::chrono::steady_clock::time_point stopped_at_;
  double* account_ = nullptr;  ///< of the clock, while the run is stopped
  double* companion_account_ = nullptr;
};

}  // namespace

RunRecord execute(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                  const ExecuteOptions& options) {
  Running running(strategy, problem, seed, options);
  running.search();
  return running.record();
}

/// The thread of a run. It and the thread that calls `advance` take turns: one of them waits at any time.
class Execution::Thread {
 public:
  Thread(StrategySpec strategy, Problem problem, std::uint64_t seed, ExecuteOptions options)
      : strategy_(std::move(strategy)), problem_(std::move(problem)), options_(std::move(options)) {
    options_.interrupted = [this, interrupted = options_.interrupted] {
      while (!abandoned_ && stop_ && stop_()) wait();
      return abandoned_ || (interrupted && interrupted());
    };
    // The levels exist before the first step, so that the run has a record.
    thread_ = std::thread([this, seed] { run(seed); });
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !runs_; });
    lock.unlock();
    if (error_ == nullptr) return;
    thread_.join();
    std::rethrow_exception(error_);
  }
  Thread(const Thread&) = delete;
  Thread& operator=(const Thread&) = delete;
  ~Thread() {
    abandoned_ = true;
    let_run({});
    thread_.join();
  }

  bool advance(std::function<bool()> stop) {
    let_run(std::move(stop));
    if (error_ != nullptr) std::rethrow_exception(error_);
    return ended_;
  }
  RunRecord record() { return running_->record(); }
  [[nodiscard]] const LevelRecord& level(std::size_t number) const { return running_->level(number); }
  [[nodiscard]] const LevelRecord* companion() { return running_->companion(); }

 private:
  /// The life of the thread of the run.
  void run(std::uint64_t seed) {
    try {
      running_.emplace(strategy_, problem_, seed, options_);
      wait();
      if (!abandoned_) running_->search();
    } catch (...) {
      error_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    ended_ = true;
    runs_ = false;
    changed_.notify_all();
  }
  /// Lets the other thread continue until it calls `let_run`.
  void wait() {
    running_->stopped();
    std::unique_lock lock(mutex_);
    runs_ = false;
    changed_.notify_all();
    changed_.wait(lock, [this] { return runs_; });
    running_->continued();
  }
  /// Lets the run continue until it waits or ends.
  void let_run(std::function<bool()> stop) {
    std::unique_lock lock(mutex_);
    if (ended_) return;
    stop_ = std::move(stop);
    runs_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !runs_; });
  }

  const StrategySpec strategy_;
  const Problem problem_;
  ExecuteOptions options_;
  std::optional<Running> running_;
  std::function<bool()> stop_;
  std::exception_ptr error_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool runs_ = true;  ///< it is the turn of the thread of the run
  bool ended_ = false;
  bool abandoned_ = false;
  std::thread thread_;
};

Execution::Execution(StrategySpec strategy, Problem problem, std::uint64_t seed, ExecuteOptions options)
    : thread_(std::make_unique<Thread>(std::move(strategy), std::move(problem), seed, std::move(options))) {}
Execution::~Execution() = default;
bool Execution::advance(std::function<bool()> stop) { return thread_->advance(std::move(stop)); }
RunRecord Execution::record() { return thread_->record(); }
const LevelRecord& Execution::level(std::size_t number) const { return thread_->level(number); }
const LevelRecord* Execution::companion() const { return thread_->companion(); }

}  // namespace trellis
