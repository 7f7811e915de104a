// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/executor.hpp>

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <trellis/instance/half_turns.hpp>
#include <trellis/instance/path_fault.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/level.hpp>
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

/// Certifies paths before they are reported. Outside of the measured time: its cost depends on the length of the path,
/// not on the search.
class PathCheck {
 public:
  using Clock = std::chrono::steady_clock;

  /// \param root  at the beginning of the run, with the validity of the actual robot
  PathCheck(const Problem& problem, const Instance& root)
      : space_(root.space), validity_(root.validity), tolerance_(certificate_tolerance(problem)) {}

  /// Certifies a path and remembers its clearance.
  [[nodiscard]] std::optional<InvalidPlace> refuted(const Configurations& path) {
    const auto begin = Clock::now();
    const double cpu_begin = thread_seconds();
    PathCertificate certificate = certify(space_, *validity_, path, tolerance_);
    checks_ += certificate.checks;
    clearance_ = certificate.clearance;
    time_ += Clock::now() - begin;
    cpu_seconds_ += thread_seconds() - cpu_begin;
    return std::move(certificate.refuted);
  }
  /// The path with the midpoints of its half turns, so that it says their directions.
  [[nodiscard]] Configurations divided(const Configurations& path) {
    const auto begin = Clock::now();
    const double cpu_begin = thread_seconds();
    Configurations result = with_half_turns_divided(space_, *validity_, path, tolerance_);
    time_ += Clock::now() - begin;
    cpu_seconds_ += thread_seconds() - cpu_begin;
    return result;
  }
  [[nodiscard]] const std::shared_ptr<Validity>& validity() const { return validity_; }
  [[nodiscard]] double tolerance() const { return tolerance_; }
  /// The clearance of the last path that was certified, in metres.
  [[nodiscard]] double clearance() const { return clearance_; }
  [[nodiscard]] Clock::duration time() const { return time_; }
  [[nodiscard]] double cpu_seconds() const { return cpu_seconds_; }
  [[nodiscard]] std::uint64_t checks() const { return checks_; }

 private:
  const Space space_;
  const std::shared_ptr<Validity> validity_;
  const double tolerance_;
  Clock::duration time_ = {};
  double cpu_seconds_ = 0.0;
  double clearance_ = 0.0;
  std::uint64_t checks_ = 0;
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
    run_.problem = problem.name;
    run_.seed = seed;
    run_.seeded = true;
    run_.interrupted = options.interrupted;
    run_.watch = options.watch;
    root_.emplace(run_, nullptr, "0", "root", root_instance(strategy, problem), strategy.planner(), nullptr);
    run_.clock.switch_to(&setup_);
    if (strategy.guide() != nullptr) root_->guide_by(*strategy.guide());
    check_path_.emplace(problem, root_->instance());
  }

  /// Searches until a path is certified, or until the root's search ends without one.
  void search() {
    solution_ = &root_->solve();
    // From the fifth refutation on the root certifies its motions, so that few more paths are refuted.
    constexpr std::uint64_t most_refuted = 1000;
    while (solution_->solved() && refuted_paths_ < most_refuted) {
      // States of a motion model are too near to each other to be half a turn apart.
      path_ = problem_.motion_model ? solution_->path : check_path_->divided(solution_->path);
      const auto place = check_path_->refuted(path_);
      if (!place) {
        certified_ = true;
        break;
      }
      ++refuted_paths_;
      root_->refute(place->invalid, check_path_->validity(), check_path_->tolerance());
      solution_ = &root_->solve();
    }
    run_.clock.switch_to(nullptr);
    ended_ = true;
    note_times();
  }

  /// The record so far. Once the search has ended, callable once.
  RunRecord record() {
    RunRecord record;
    record.solved = record.certified = certified_;
    record.status = !ended_                              ? Status::interrupted
                    : solution_->solved() && !certified_ ? Status::budget_spent
                                                         : solution_->status;
    record.seconds = seconds_;
    record.cpu_seconds = cpu_seconds_;
    for (Level* level : run_.levels) {
      record.validity_checks += level->instance().checks.validity;
      record.motion_checks += level->instance().checks.motion;
    }
    if (record.solved) add_path(record);
    record.refuted_paths = refuted_paths_;
    record.path_checks = check_path_->checks();
    record.path_seconds = check_path_->cpu_seconds();
    record.turns = run_.turns;
    if (!ended_ && run_.active_level != nullptr) run_.active_level->add_open_turn(record.turns);
    for (Level* level : run_.levels) {
      record.levels.push_back(ended_ ? level->take_record(options_.lift) : level->record_so_far(options_.lift));
    }
    add_spent_below(record.levels);
    // The root's solution is the reported path.
    if (record.solved) record.levels.front().solution.path = record.path;
    record.improvements = run_.improvements;
    return record;
  }

  [[nodiscard]] const LevelRecord& level(std::size_t number) const { return run_.levels.at(number)->record(); }

  /// Called by the thread of the run before and after it waits: waiting counts for no level.
  void stopped() {
    note_times();
    stopped_at_ = std::chrono::steady_clock::now();
    account_ = run_.clock.switch_to(nullptr);
  }
  void continued() {
    run_.clock.switch_to(account_);
    run_.stopped += std::chrono::duration<double>(std::chrono::steady_clock::now() - stopped_at_).count();
  }

 private:
  /// Called by the thread of the run: its CPU time is that thread's.
  void note_times() {
    const auto elapsed = std::chrono::steady_clock::now() - begin_ - check_path_->time();
    seconds_ = std::chrono::duration<double>(elapsed).count() - run_.stopped;
    cpu_seconds_ = thread_seconds() - run_.cpu_begin - check_path_->cpu_seconds();
  }

  void add_path(RunRecord& record) {
    record.path = path_;
    record.trajectory = solution_->trajectory;
    // Straight motions cannot shortcut a path with a motion model.
    if (options_.shortcut > 0 && !problem_.motion_model) {
      Checks& checks = root_->instance().checks;
      const Checks planned = checks;
      Stream stream(run_.seed, "0", "shortcut");
      const auto certified = [&](const Configurations& part) { return !check_path_->refuted(part); };
      record.path =
          check_path_->divided(shortcut(root_->instance(), record.path, options_.shortcut, stream, certified));
      // Its clearance, and a last look: parts of motions were certified one by one.
      if (check_path_->refuted(record.path)) {
        record.path = path_;
        static_cast<void>(check_path_->refuted(record.path));
      }
      record.shortcut_checks = checks.validity - planned.validity;
      checks = planned;
    }
    record.length = path_length(problem_.space, record.path);
    record.clearance = check_path_->clearance();
  }

  const Problem& problem_;
  const ExecuteOptions& options_;
  std::chrono::steady_clock::time_point begin_;
  Run run_;
  double setup_ = 0.0;
  std::optional<Level> root_;
  std::optional<PathCheck> check_path_;
  const Solution* solution_ = nullptr;  ///< of the root, once it has ended a solve
  Configurations path_;                 ///< the last one found
  std::uint64_t refuted_paths_ = 0;
  bool certified_ = false;
  bool ended_ = false;
  double seconds_ = 0.0;
  double cpu_seconds_ = 0.0;
  std::chrono::steady_clock::time_point stopped_at_;
  double* account_ = nullptr;  ///< of the clock, while the run is stopped
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
      while (!abandoned_ && stop_()) wait();
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

}  // namespace trellis
