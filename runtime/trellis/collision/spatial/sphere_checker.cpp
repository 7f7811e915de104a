// SPDX-License-Identifier: GPL-3.0-or-later
// The checker of manipulators: balls among the obstacles of space, and against each other.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/collision/common.hpp>
#include <trellis/collision/orders.hpp>
#include <trellis/scene/cache_by_world.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/obstacle_distance.hpp>

namespace trellis {

namespace {

/// What all checkers of a world share.
std::shared_ptr<const ObstacleDistance> distance_in(const World3& world) {
  static CacheByWorld<ObstacleDistance> cache;
  return cache.get(world, [](const World3& of) {
    std::vector<Solid> solids;
    solids.reserve(of.obstacles().size());
    for (const Obstacle3& obstacle : of.obstacles()) solids.push_back(obstacle.solid);
    return ObstacleDistance(solids, of.surface());
  });
}

class SphereChecker final : public Checker {
 public:
  SphereChecker(std::shared_ptr<const Scene> scene, const Space& space, double resolution)
      : scene_(std::move(scene)),
        world_(scene_->manipulator()->world),
        model_(scene_->manipulator()->robot),
        robot_(model_.robot()),
        base_(scene_->manipulator()->base),
        space_(space),
        resolution_(resolution),
        slack_(touching_slack(*scene_)),
        distance_(distance_in(world_)),
        q_(space.dimension()),
        change_(space.dimension()) {
    check_fits(*scene_, space, resolution);
    for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
      // The base does not move: it is checked as the others, so that a base in an obstacle is found.
      if (!model_.bodies()[b].empty()) solid_.push_back(b);
    }
    placed_.resize(model_.bodies().size());
    for (std::size_t b = 0; b < placed_.size(); ++b) placed_[b].resize(model_.bodies()[b].size());
  }

  [[nodiscard]] bool valid(View q) const override { return is_finite(q, robot_.dimension()) && free_at(q); }

  [[nodiscard]] MotionReport motion(View a, View b) const override {
    if (!is_finite(a, robot_.dimension()) || !is_finite(b, robot_.dimension())) return {false, 1, 1.0};
    const std::uint32_t n = configurations_of(displacement(a, b), resolution_);
    const Order& order = order_of(n);
    for (std::uint32_t rank = 0; rank < n; ++rank) {
      const double share = order.share(rank);
      space_.interpolate(a, b, share, q_);
      if (!free_at(q_)) return {false, rank + 1, share};
    }
    return {true, n, std::numeric_limits<double>::quiet_NaN()};
  }

  void certify(View a, View b, Certificate& certificate) const override {
    if (!is_finite(a, robot_.dimension()) || !is_finite(b, robot_.dimension())) {
      certificate.refuted_at = is_finite(a, robot_.dimension()) ? 1.0 : 0.0;
      return;
    }
    Clearances motion(*this, a, b);
    const double first =
        std::isfinite(certificate.nearest) ? std::max(resolution_, 2.0 * certificate.nearest) : resolution_;
    // Two bodies approach each other by the displacements of both.
    add_motion(certificate, motion, 2.0 * motion.displacement(), first);
  }

  [[nodiscard]] double clearance(View q) const override {
    if (!is_finite(q, robot_.dimension())) return 0.0;
    place(q);
    const double found = distance_at(std::numeric_limits<double>::infinity(), nullptr);
    return found <= slack_ ? 0.0 : found;
  }

  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) const override {
    if (world_.obstacles().empty()) return std::nullopt;
    place(q);
    Proximity found{0, std::numeric_limits<double>::infinity(), std::nullopt};
    for (const std::size_t b : solid_) {
      for (std::size_t i = 1; i < placed_[b].size(); ++i) {
        const NearestObstacle near = distance_->nearest(placed_[b][i]);
        const double distance = near.distance - model_.bodies()[b][i].radius;
        if (distance < found.distance) found = {near.obstacle, distance, near.point};
      }
    }
    if (found.distance <= slack_) found = {found.obstacle, 0.0, std::nullopt};
    return found;
  }

  [[nodiscard]] std::optional<Contact> contact(View q) const override {
    if (!is_finite(q, robot_.dimension())) return Contact{0, std::nullopt};
    place(q);
    for (const std::size_t b : solid_) {
      if (margin_of(b) <= -slack_) return Contact{b, std::nullopt};
      std::optional<std::size_t> first;
      for (std::size_t i = 1; i < placed_[b].size(); ++i) {
        const NearestObstacle near = distance_->nearest(placed_[b][i]);
        if (near.distance - model_.bodies()[b][i].radius <= slack_)
          first = std::min(first.value_or(near.obstacle), near.obstacle);
      }
      if (first) return Contact{b, first};
    }
    for (const auto& [a, b] : model_.pairs()) {
      if (gap(a, b, std::numeric_limits<double>::infinity()) <= slack_) return Contact{a, std::nullopt, b};
    }
    return std::nullopt;
  }

 private:
  /// A bound on how far the robot's points move from a to b.
  [[nodiscard]] double displacement(View a, View b) const {
    space_.difference(a, b, change_);
    double most = 0.0;
    for (const std::size_t body : solid_) most = std::max(most, robot_.displacement_bound(body, change_));
    return most;
  }

  /// Places all balls at q.
  void place(View q) const {
    robot_.poses(q, poses_);
    for (const std::size_t b : solid_) {
      const Pose3 pose = base_ * poses_[b];
      for (std::size_t i = 0; i < placed_[b].size(); ++i) placed_[b][i] = pose(model_.bodies()[b][i].centre);
    }
  }

  /// The distance of a body from the bounds that contain it; infinity where none do.
  [[nodiscard]] double margin_of(std::size_t body) const {
    if (world_.contain() != Contain::robot) return std::numeric_limits<double>::infinity();
    const auto& [lo, hi] = world_.bounds();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < placed_[body].size(); ++i) {
      const Vec3& p = placed_[body][i];
      const double r = model_.bodies()[body][i].radius;
      least = std::min(
          {least, p.x - lo.x - r, p.y - lo.y - r, p.z - lo.z - r, hi.x - p.x - r, hi.y - p.y - r, hi.z - p.z - r});
    }
    return least;
  }

  /// The distance of two bodies, or `enough` where it is not less.
  [[nodiscard]] double gap(std::size_t a, std::size_t b, double enough) const {
    const auto& first = model_.bodies()[a];
    const auto& second = model_.bodies()[b];
    if (first.empty() || second.empty()) return enough;
    double least = enough;
    if (norm(placed_[a][0] - placed_[b][0]) - first[0].radius - second[0].radius >= least) return least;
    for (std::size_t i = 1; i < first.size(); ++i) {
      if (norm(placed_[a][i] - placed_[b][0]) - first[i].radius - second[0].radius >= least) continue;
      for (std::size_t j = 1; j < second.size(); ++j) {
        least = std::min(least, norm(placed_[a][i] - placed_[b][j]) - first[i].radius - second[j].radius);
      }
    }
    return least;
  }

  [[nodiscard]] bool free_at(View q) const {
    place(q);
    for (const std::size_t b : solid_) {
      if (margin_of(b) <= -slack_) return false;
      const auto& balls = model_.bodies()[b];
      if ((*distance_)(placed_[b][0]) - balls[0].radius > slack_) continue;
      for (std::size_t i = 1; i < balls.size(); ++i) {
        if ((*distance_)(placed_[b][i]) - balls[i].radius <= slack_) return false;
      }
    }
    return std::all_of(model_.pairs().begin(), model_.pairs().end(), [&](const auto& pair) {
      constexpr double far = 1.0;
      return gap(pair.first, pair.second, far) > slack_;
    });
  }

  /// The least distance of the placed robot from everything, `at_most` where it is not less.
  /// \param sure  receives the least of these distances less the displacements of the bodies: `moved` of each
  [[nodiscard]] double distance_at(double at_most, const std::vector<double>* moved, double* sure = nullptr) const {
    double least = at_most;
    double certain = at_most;
    const auto note = [&](double distance, double by) {
      least = std::min(least, distance);
      certain = std::min(certain, distance - by);
    };
    for (const std::size_t b : solid_) {
      const double by = moved != nullptr ? (*moved)[b] : 0.0;
      note(margin_of(b), by);
      const auto& balls = model_.bodies()[b];
      const double whole = (*distance_)(placed_[b][0]) - balls[0].radius;
      if (whole - by >= certain && whole >= least) continue;
      for (std::size_t i = 1; i < balls.size(); ++i) note((*distance_)(placed_[b][i]) - balls[i].radius, by);
    }
    for (const auto& [a, b] : model_.pairs()) {
      const double by = moved != nullptr ? (*moved)[a] + (*moved)[b] : 0.0;
      const double enough = std::max(least, certain + by);
      if (const double found = gap(a, b, enough); found < enough) note(found, by);
    }
    if (sure != nullptr) *sure = certain;
    return least;
  }

  /// The distances on a motion.
  class Clearances final : public MotionClearance {
   public:
    Clearances(const SphereChecker& checker, View a, View b)
        : checker_(checker), a_(a), b_(b), whole_(checker.model_.bodies().size(), 0.0), moved_(whole_.size()) {
      checker.space_.difference(a, b, checker.change_);
      for (const std::size_t body : checker.solid_) {
        whole_[body] = checker.robot_.displacement_bound(body, checker.change_);
        displacement_ = std::max(displacement_, whole_[body]);
      }
    }
    [[nodiscard]] double displacement() const { return displacement_; }

    [[nodiscard]] unsigned apart(std::span<const double> shares, double half, double margin) override {
      unsigned found = 0;
      for (std::size_t i = 0; i < shares.size(); ++i) {
        if (near(shares[i], half, margin + checker_.slack_).sure > margin) found |= 1U << i;
      }
      return found;
    }
    [[nodiscard]] Near near(double share, double half, double at_most) override {
      checker_.space_.interpolate(a_, b_, share, checker_.q_);
      checker_.place(checker_.q_);
      for (std::size_t b = 0; b < whole_.size(); ++b) moved_[b] = half * whole_[b];
      double sure = 0.0;
      const double distance = checker_.distance_at(at_most + 2.0 * half * displacement_, &moved_, &sure);
      if (distance <= checker_.slack_) return {0.0, std::min(sure, 0.0)};
      return {std::min(distance, at_most), std::min(sure - checker_.slack_, at_most)};
    }

   private:
    const SphereChecker& checker_;
    View a_;
    View b_;
    std::vector<double> whole_;  ///< of each body, on the whole motion
    std::vector<double> moved_;
    double displacement_ = 0.0;
  };

  std::shared_ptr<const Scene> scene_;
  const World3& world_;
  const SphereModel& model_;
  const Manipulator& robot_;
  Pose3 base_;
  Space space_;
  double resolution_;
  double slack_;
  std::shared_ptr<const ObstacleDistance> distance_;
  std::vector<std::size_t> solid_;  ///< bodies with balls
  // Scratch.
  mutable Configuration q_;
  mutable Configuration change_;
  mutable std::vector<Pose3> poses_;
  mutable std::vector<std::vector<Vec3>> placed_;  ///< the centres of each body's balls
};

}  // namespace

std::unique_ptr<Checker> make_sphere_checker(std::shared_ptr<const Scene> scene, const Space& space,
                                             double resolution) {
  return std::make_unique<SphereChecker>(std::move(scene), space, resolution);
}

}  // namespace trellis
