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
    run_.ledger.begin(options);
    run_.cpu_begin = thread_seconds();
    run_.lua_begin = lua_seconds();
    run_.lua_depth = lua_depth();
    run_.problem = problem.name;
    run_.seed = seed;
    run_.seeded = true;
    run_.densities = options.measured;
    if (options.watch) run_.watch = &options.watch;
    if (options.threads > 1) run_.helpers = &helpers_.emplace(options.threads);
    root_.emplace(run_, strategy, problem);
    if (const double seconds = root_->level().common().budget.seconds; seconds < Budget::unlimited) {
      run_.ledger.limit_time(seconds);
    }
    anytime_ = find_planner(strategy.planner().name())->component->find("improve") != nullptr;
    run_.clock.switch_to(&setup_);
    root_->level().heuristic().report_paths([this](double length) { note_improvement(run_, length); });
    if (strategy.guide() == nullptr) return;
    const PlannerCommon& common = root_->level().common();
    bound_ = options.companion ? common.bound : 0.0;
    run_.ledger.share_set_up(common.queries);
    if (common.queries <= 1.0) own_set_ups_.emplace();
    const OwnSetUpsScope unshared(own_set_ups());
    const SharedSetUpsScope recorded(&shared_set_ups_);
    guides_ = strategy.guide();
    double estimated = 0.0;
    if (bound_ > 0.0) {
      estimated = set_up_work(*guides_, *problem.scene, common.queries);
      root_->level().rely_on_companion();
      companion_.emplace(strategy, problem, run_);
      companion_->search().level().heuristic().report_paths(
          [this](double length) { note_improvement(companion_->run(), length); });
      run_.ledger.rely_on(*companion_, bound_, estimated);
    }
    // Otherwise the companion goes first.
    if (estimated <= companion_constant.work) set_up();
  }

  /// Searches until a path is certified, or until no search is left.
  void search() {
    const OwnSetUpsScope unshared(own_set_ups());
    const SharedSetUpsScope recorded(&shared_set_ups_);
    RunLedger& ledger = run_.ledger;
    const bool is_set_up = guides_ == nullptr || ledger.guides_set_up();
    if (!ledger.ending() && (is_set_up || (ledger.companion_goes_first() && set_up()))) {
      const MonitorScope monitored(ledger.monitor());
      while (!root_->ended()) root_->step();
    }
    ledger.end_search();
    if (companion_ && !root_->certified() && !ledger.interrupted()) {
      // What the unguided planner finds, a guided run finds too.
      constexpr double all = std::numeric_limits<double>::infinity();
      companion_->keep_up({all, all}, run_.clock);
      companion_decides_ = root_->status() == Status::interrupted || companion_->search().certified();
    } else if (ledger.ending() && companion_->search().certified()) {
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
    const SharedSetUpsScope recorded(&shared_set_ups_);
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
    record.work = run_.ledger.total().work;
    if (run_.ledger.guides_set_up()) {
      constexpr double all = std::numeric_limits<double>::infinity();
      record.set_up = set_up_work(*guides_, *problem_.scene, 1.0);
      if (record.set_up > set_up_work(*guides_, *problem_.scene, all)) record.queries = run_.ledger.queries();
    }
    record.set_up_seconds = std::max(0.0, run_.ledger.set_up_seconds() - shared_in_set_up_);
    record.shared_set_up_seconds = shared_set_ups_.seconds();
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
    run_.ledger.wait(waited);
    if (!companion_) return;
    companion_->run().clock.switch_to(companion_account_);
    companion_->run().ledger.wait(waited);
  }

 private:
  /// nullptr: the run shares what its guides compute of worlds.
  [[nodiscard]] OwnSetUps* own_set_ups() { return own_set_ups_ ? &*own_set_ups_ : nullptr; }

  /// Called by the thread of the run: its CPU time is that thread's.
  void note_times() {
    seconds_ = run_.ledger.elapsed();
    cpu_seconds_ = thread_seconds() - run_.cpu_begin + (helpers_ ? helpers_->cpu_seconds() : 0.0);
    lua_seconds_ = lua_seconds() - run_.lua_begin;
    for (RootSearch* search : searches()) {
      seconds_ -= std::chrono::duration<double>(search->check_path().time()).count();
      cpu_seconds_ -= search->check_path().cpu_seconds();
    }
    // Whichever run is the first in a world computes what all use.
    seconds_ = std::max(0.0, seconds_ - shared_set_ups_.spent());
    cpu_seconds_ = std::max(0.0, cpu_seconds_ - shared_set_ups_.cpu_spent());
  }

  /// Makes the levels of the guides. Returns whether that ended.
  bool set_up() {
    const double before = shared_set_ups_.spent();
    const bool ended = run_.ledger.set_up([this] {
      try {
        root_->level().guide_by(*guides_);
      } catch (const SearchEnded&) {
        run_.abandons_levels = false;
        return false;
      }
      return true;
    });
    shared_in_set_up_ += shared_set_ups_.spent() - before;
    return ended;
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
    improvements.push_back({checks, thread_seconds() - run_.cpu_begin - shared_set_ups_.cpu_spent(), length});
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
                      .largest_step = run_.ledger.largest_step(),
                      .guided = run_.ledger.cost(),
                      .unguided = companion_->cost(),
                      .set_up = run_.ledger.set_up_work(),
                      .guides_set_up = run_.ledger.guides_set_up(),
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
  std::optional<HelperThreads> helpers_;
  std::optional<OwnSetUps> own_set_ups_;  ///< of a run that is the only one in its world
  SharedSetUps shared_set_ups_;           ///< those of others
  double shared_in_set_up_ = 0.0;         ///< what it spent on these while it set up the guides
  Run run_;
  double setup_ = 0.0;
  bool anytime_ = false;  ///< the root's planner continues after its first path
  double bound_ = 0.0;
  const GuideSpec* guides_ = nullptr;
  std::optional<RootSearch> root_;
  std::optional<Companion> companion_;
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
