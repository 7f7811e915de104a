// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/executor.hpp>

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <optional>
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

}  // namespace

RunRecord execute(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                  const ExecuteOptions& options) {
  check(problem);
  check_depth(strategy);
  check_scale(strategy, problem);
  const auto begin = std::chrono::steady_clock::now();
  Run run;
  run.cpu_begin = thread_seconds();
  run.problem = problem.name;
  run.seed = seed;
  run.seeded = true;
  run.interrupted = options.interrupted;
  run.watch = options.watch;
  Level root(run, nullptr, "0", "root", root_instance(strategy, problem), strategy.planner(), nullptr);
  double setup = 0.0;
  run.clock.switch_to(&setup);
  if (strategy.guide() != nullptr) root.guide_by(*strategy.guide());
  RunRecord record;
  PathCheck check_path(problem, root.instance());
  const Solution* solution = &root.solve();
  Configurations path;
  // From the fifth refutation on the root certifies its motions, so that few more paths are refuted.
  constexpr std::uint64_t most_refuted = 1000;
  while (solution->solved() && record.refuted_paths < most_refuted) {
    // States of a motion model are too near to each other to be half a turn apart.
    path = problem.motion_model ? solution->path : check_path.divided(solution->path);
    const auto place = check_path.refuted(path);
    if (!place) {
      record.certified = true;
      break;
    }
    ++record.refuted_paths;
    root.refute(place->invalid, check_path.validity(), check_path.tolerance());
    solution = &root.solve();
  }
  const Solution& found = *solution;
  run.clock.switch_to(nullptr);

  record.solved = record.certified;
  record.status = found.solved() && !record.certified ? Status::budget_spent : found.status;
  record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin - check_path.time()).count();
  record.cpu_seconds = thread_seconds() - run.cpu_begin - check_path.cpu_seconds();
  for (Level* level : run.levels) {
    record.validity_checks += level->instance().checks.validity;
    record.motion_checks += level->instance().checks.motion;
  }
  const Checks planned = root.instance().checks;
  if (record.solved) {
    record.path = path;
    record.trajectory = found.trajectory;
    // Straight motions cannot shortcut a path with a motion model.
    if (options.shortcut > 0 && !problem.motion_model) {
      Stream stream(seed, "0", "shortcut");
      const auto certified = [&](const Configurations& part) { return !check_path.refuted(part); };
      record.path = check_path.divided(shortcut(root.instance(), record.path, options.shortcut, stream, certified));
      // Its clearance, and a last look: parts of motions were certified one by one.
      if (check_path.refuted(record.path)) {
        record.path = path;
        static_cast<void>(check_path.refuted(record.path));
      }
      record.shortcut_checks = root.instance().checks.validity - planned.validity;
      root.instance().checks = planned;
    }
    record.length = path_length(problem.space, record.path);
    record.clearance = check_path.clearance();
  }
  record.path_checks = check_path.checks();
  record.path_seconds = check_path.cpu_seconds();
  for (Level* level : run.levels) record.levels.push_back(level->take_record(options.lift));
  add_spent_below(record.levels);
  // The root's solution is the reported path.
  if (record.solved) record.levels.front().solution.path = record.path;
  record.turns = std::move(run.turns);
  record.improvements = std::move(run.improvements);
  return record;
}

}  // namespace trellis
