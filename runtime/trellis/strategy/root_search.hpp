// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/excluded.hpp>
#include <trellis/instance/certified_validity.hpp>
#include <trellis/instance/half_turns.hpp>
#include <trellis/instance/path_fault.hpp>
#include <trellis/instance/revisable_validity.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/level.hpp>

namespace trellis {

/// Certifies paths before they are reported. Outside of the measured time: its cost depends on the length of the path,
/// not on the search.
class PathCheck {
 public:
  using Clock = std::chrono::steady_clock;

  /// \param root  at the beginning of the run, with the validity of the actual robot
  PathCheck(const Problem& problem, const Instance& root)
      : space_(root.space), validity_(root.validity), tolerance_(certificate_tolerance(problem)) {}

  /// Certifies a path and remembers its clearance. Returns the place where it is refuted.
  [[nodiscard]] std::optional<InvalidPlace> refuted(const Configurations& path) {
    const Timed timed(*this);
    return refute(path);
  }
  /// The path with the midpoints of its half turns, so that it says their directions.
  [[nodiscard]] Configurations divided(const Configurations& path) {
    const Timed timed(*this);
    return with_half_turns_divided(space_, *validity_, path, tolerance_);
  }
  /// Both, for less time of clocks: divides the path, then certifies it.
  [[nodiscard]] std::optional<InvalidPlace> divide_and_refute(Configurations& path) {
    const Timed timed(*this);
    path = with_half_turns_divided(space_, *validity_, path, tolerance_);
    return refute(path);
  }
  [[nodiscard]] const std::shared_ptr<Validity>& validity() const { return validity_; }
  [[nodiscard]] double tolerance() const { return tolerance_; }
  /// The clearance of the last path that was certified, in metres.
  [[nodiscard]] double clearance() const { return clearance_; }
  [[nodiscard]] Clock::duration time() const { return time_; }
  [[nodiscard]] double cpu_seconds() const { return cpu_seconds_; }
  [[nodiscard]] std::uint64_t checks() const { return checks_; }

 private:
  /// Adds the time of its life.
  class Timed {
   public:
    explicit Timed(PathCheck& check) : check_(check), begin_(Clock::now()), cpu_begin_(thread_seconds()) {}
    Timed(const Timed&) = delete;
    Timed& operator=(const Timed&) = delete;
    ~Timed() {
      check_.time_ += Clock::now() - begin_;
      check_.cpu_seconds_ += thread_seconds() - cpu_begin_;
    }

   private:
    PathCheck& check_;
    Clock::time_point begin_;
    double cpu_begin_;
    MonitorScope unmonitored_{nullptr};
  };

  [[nodiscard]] std::optional<InvalidPlace> refute(const Configurations& path) {
    PathCertificate certificate = certify(space_, *validity_, path, tolerance_);
    checks_ += certificate.checks;
    clearance_ = certificate.clearance;
    return std::move(certificate.refuted);
  }

  const Space space_;
  const std::shared_ptr<Validity> validity_;
  const double tolerance_;
  Clock::duration time_ = {};
  double cpu_seconds_ = 0.0;
  double clearance_ = 0.0;
  std::uint64_t checks_ = 0;
};

/// The search of the root level for a path that can be certified, one step at a time.
class RootSearch {
 public:
  RootSearch(Run& run, const StrategySpec& strategy, const Problem& problem)
      : run_(run),
        problem_(problem),
        root_(run, nullptr, "0", "root", root_instance(strategy, problem), strategy.planner(), nullptr),
        check_path_(problem, root_.instance()) {
    // Other spaces may hold the root's validity.
    if (strategy.guide() != nullptr || strategy.planner().dividing() != nullptr) make_revisable();
  }

  void step() {
    try {
      take_step();
    } catch (const SearchEnded&) {
      run_.leave_searches();
      if (root_.found()) return decide();
      status_ = Status::interrupted;
      certified_ = false;
      end();
    }
  }

  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] bool certified() const { return certified_; }
  /// The status with which it ended.
  [[nodiscard]] Status status() const { return status_; }
  /// The last path found.
  [[nodiscard]] const Configurations& path() const { return path_; }
  [[nodiscard]] std::uint64_t refuted_paths() const { return refuted_paths_; }
  [[nodiscard]] Level& level() { return root_; }
  [[nodiscard]] PathCheck& check_path() { return check_path_; }

 private:
  void take_step() {
    if (!std::exchange(begun_, true)) root_.begin_root();
    if (!root_.ended()) root_.take_step();
    if (!root_.ended()) return;
    root_.end();
    decide();
  }
  /// Certifies the path of a solve that has ended. Begins another solve where it cannot be certified.
  void decide() {
    status_ = root_.solution().status;
    if (!root_.found()) {
      end();
      return;
    }
    // States of a motion model are too near to each other to be half a turn apart.
    path_ = root_.solution().path;
    const auto place = problem_.motion_model ? check_path_.refuted(path_) : check_path_.divide_and_refute(path_);
    certified_ = !place;
    constexpr std::uint64_t most_refuted = 1000;
    if (certified_ || ++refuted_paths_ >= most_refuted || run_.ledger.ending()) {
      if (!certified_) status_ = run_.ledger.ending() ? Status::interrupted : Status::budget_spent;
      end();
      return;
    }
    revise(place->invalid);
    root_.refute();
    root_.begin_root();
  }
  void make_revisable() {
    validity_ = std::make_shared<RevisableValidity>(root_.instance().validity);
    root_.instance().validity = validity_;
  }
  /// Excludes a small ball about a configuration at which a path was refuted; or has the root certify its motions,
  /// those of the present search included.
  void revise(View invalid) {
    // As many paths are refuted before the resolution counts as too coarse for the world.
    constexpr std::uint64_t at_most = 4;
    if (!validity_) make_revisable();
    Instance& instance = root_.instance();
    // Earlier epochs are those of another validity.
    instance.revision = instance.epoch() + 1;
    if (refuted_paths_ == at_most + 1) {
      const auto certifies = std::make_shared<CertifiedValidity>(check_path_.validity(), check_path_.tolerance());
      return validity_->replace(certifies);
    }
    // Start and goals remain valid.
    const double nearest = std::min(instance.space.distance(invalid, instance.start), instance.to_goal(invalid));
    const auto excluding = std::make_shared<ExcludingValidity>(validity_->current(), instance.space,
                                                               std::min(0.25 * instance.resolution, 0.5 * nearest));
    Configurations points(instance.space.dimension());
    points.push(invalid);
    excluding->exclude_points(points);
    validity_->exclude(excluding);
  }
  void end() {
    run_.clock.switch_to(nullptr);
    ended_ = true;
  }

  Run& run_;
  const Problem& problem_;
  Level root_;
  PathCheck check_path_;
  std::shared_ptr<RevisableValidity> validity_;  ///< of the root, once it may be revised; check_path_ has the first one
  Status status_ = Status::interrupted;
  Configurations path_;
  std::uint64_t refuted_paths_ = 0;
  bool begun_ = false;
  bool certified_ = false;
  bool ended_ = false;
};

}  // namespace trellis
