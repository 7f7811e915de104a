// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/collision/common.hpp>
#include <trellis/collision/spatial/body_phase.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis {

namespace {

/// A team of bodies: each among the obstacles, and each two against each other. What a body touches of another one is
/// decided in the frame of that one, whose solids are the obstacles there.
class TeamPhase final : public NarrowPhase {
 public:
  TeamPhase(std::shared_ptr<const Scene> scene, Space space, bool filtered)
      : scene_(std::move(scene)), robot_(spatial(*scene_).robot), space_(std::move(space)), q_(space_.dimension()) {
    slack_ = touching_slack(*scene_);
    const World3& world = spatial(*scene_).world;
    std::map<const Robot3*, std::shared_ptr<const BodyPhase>> alone;
    std::map<std::pair<const Robot3*, const Robot3*>, std::shared_ptr<const BodyPhase>> pairs;
    for (const Robot3::Member& member : robot_.members()) {
      auto& phase = alone[member.robot.get()];
      if (!phase) phase = phase_of(world, *member.robot, filtered);
      bodies_.push_back({&member, phase});
    }
    // As large as the world, so that the same gaps count as touching.
    const double size = scene_->magnitude();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      for (std::size_t k = i + 1; k < bodies_.size(); ++k) {
        if (!robot_.are_coupled(bodies_[i].member->number, bodies_[k].member->number)) continue;
        const Robot3& body = *bodies_[i].member->robot;
        const Robot3& other = *bodies_[k].member->robot;
        auto& phase = pairs[{&body, &other}];
        if (!phase) {
          std::vector<Obstacle3> solids;
          for (const Solid& solid : other.solids()) {
            solids.push_back(
                {fmt::format("shape {} of robot {}", solids.size() + 1, bodies_[k].member->number), solid});
          }
          phase = phase_of(
              World3({{-size, -size, -size}, {size, size, size}}, std::move(solids), Contain::none, world.surface()),
              body, false);
        }
        pairs_.push_back({i, k, body.bounding_radius() + other.bounding_radius(), phase});
      }
    }
    poses_.resize(bodies_.size());
  }

  [[nodiscard]] double displacement(View a, View b) const override { return robot_.displacement_bound(a, b); }

  Decision begin(View a, View b, std::uint32_t n) override {
    a_ = a;
    b_ = b;
    n_ = n;
    motions_.emplace(*this, a, b);
    free_.assign(bodies_.size() * row(), 0);
    // Pairs that are not apart from each other throughout.
    place(b);
    near_.clear();
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      if (gap(pairs_[p]) <= motions_->of_pair[p].displacement + slack_) near_.push_back(p);
    }
    return Decision::undecided;
  }

  Batch check(const Order& order, std::uint32_t rank) override {
    return one_by_one(rank, n_, [&](std::uint32_t at) {
      space_.interpolate(a_, b_, order.share(at), q_);
      place(q_);
      return body_touches(order.indices[at], gap_before(at)) ||
             std::any_of(near_.begin(), near_.end(), [&](std::size_t p) { return meet(pairs_[p]); });
    });
  }

  bool sweep(View /*a*/, View /*b*/, Certificate& /*certificate*/) override { return false; }

  Distances on(View a, View b, double longest) override {
    clearances_.emplace(*this, a, b);
    return {*clearances_, clearances_->displacement(), longest};
  }

  [[nodiscard]] bool touches(View q) const override {
    place(q);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!bodies_[i].phase->valid_at(poses_[i])) return true;
    }
    return std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) { return meet(pair); });
  }

  [[nodiscard]] double clearance(View q) const override {
    if (touches(q)) return 0.0;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      best = std::min(best, bodies_[i].phase->clearance_at(poses_[i]));
    }
    for (const Pair& pair : pairs_) {
      if (gap(pair) < best) best = std::min(best, pair.phase->clearance_at(between(pair)));
    }
    return best;
  }

  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) const override {
    std::optional<Proximity> nearest;
    for (const Body& body : bodies_) {
      const auto found = body.phase->nearest_obstacle(body.member->own(q));
      if (!found) continue;
      const bool before = !nearest || found->distance < nearest->distance ||
                          (found->distance == nearest->distance && found->obstacle < nearest->obstacle);
      if (before) nearest = found;
    }
    return nearest;
  }

  [[nodiscard]] std::optional<Contact> contact(View q) const override {
    place(q);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!bodies_[i].phase->valid_at(poses_[i])) return Contact{i, bodies_[i].phase->met_obstacle(poses_[i])};
    }
    for (const Pair& pair : pairs_) {
      if (meet(pair)) return Contact{pair.body, std::nullopt, pair.other};
    }
    return std::nullopt;
  }

 private:
  struct Body {
    const Robot3::Member* member;
    std::shared_ptr<const BodyPhase> phase;  ///< in the world
  };
  /// Two bodies. The solids of the second are the obstacles of the narrow phase's world, at its pose 0.
  struct Pair {
    std::size_t body;
    std::size_t other;
    double reach;  ///< the sum of their bounding radii
    std::shared_ptr<const BodyPhase> phase;
  };

  /// The motions of all bodies, and of each two against each other, without the poses.
  struct Motions {
    Motions(const TeamPhase& phase, View a, View b) {
      for (const Body& body : phase.bodies_) {
        const Robot3& robot = *body.member->robot;
        SeenMotion& motion = of_body.emplace_back();
        motion.whole = body_motion(robot.pose(body.member->own(a)), robot.pose(body.member->own(b)));
        motion.displacement = robot.displacement_bound(body.member->own(a), body.member->own(b));
      }
      for (const Pair& pair : phase.pairs_) {
        const BodyMotion& body = of_body[pair.body].whole;
        const BodyMotion& other = of_body[pair.other].whole;
        const double radius = phase.bodies_[pair.body].member->robot->bounding_radius();
        SeenMotion& motion = of_pair.emplace_back();
        // As one sees it who moves with the other body and does not turn.
        motion.whole = {{}, body.translation - other.translation, body.axis, body.turn};
        motion.rest = phase.bodies_[pair.other].member->robot->bounding_radius() * other.turn;
        motion.displacement = norm(motion.whole.translation) + radius * body.turn + motion.rest;
      }
    }

    std::vector<SeenMotion> of_body;
    std::vector<SeenMotion> of_pair;  ///< in the frame of the world
  };

  /// The distances of all bodies on a motion.
  class Clearances final : public MotionClearance {
   public:
    Clearances(const TeamPhase& phase, View a, View b) : phase_(phase), motions_(phase, a, b), a_(a), b_(b) {
      for (const SeenMotion& motion : motions_.of_body) displacement_ = std::max(displacement_, motion.displacement);
      for (const SeenMotion& motion : motions_.of_pair) displacement_ = std::max(displacement_, motion.displacement);
    }

    /// Of all bodies on the whole motion, and of two against each other, in metres.
    [[nodiscard]] double displacement() const { return displacement_; }

    [[nodiscard]] unsigned apart(std::span<const double> shares, double half, double margin) override {
      unsigned found = 0;
      for (std::size_t i = 0; i < shares.size(); ++i) {
        if (apart_at(shares[i], half, margin)) found |= 1U << i;
      }
      return found;
    }

    [[nodiscard]] Near near(double share, double half, double at_most) override {
      place(share);
      Near all{at_most, at_most, false};
      const auto add = [&](const Near& near) {
        all.distance = std::min(all.distance, near.distance);
        if (near.sure < all.sure) all.inexact = near.inexact;
        all.sure = std::min(all.sure, near.sure);
        return all.distance > 0.0;
      };
      for (std::size_t i = 0; i < phase_.bodies_.size(); ++i) {
        if (!add(phase_.bodies_[i].phase->near_throughout(motions_.of_body[i], half, all.distance))) return all;
      }
      for (std::size_t p = 0; p < phase_.pairs_.size(); ++p) {
        const Pair& pair = phase_.pairs_[p];
        if (phase_.gap(pair) >= all.distance + half * motions_.of_pair[p].displacement) continue;
        if (!add(pair.phase->near_throughout(seen(p), half, all.distance))) return all;
      }
      return all;
    }

   private:
    void place(double share) {
      phase_.space_.interpolate(a_, b_, share, phase_.q_);
      phase_.place(phase_.q_);
      for (std::size_t i = 0; i < phase_.bodies_.size(); ++i) motions_.of_body[i].pose = phase_.poses_[i];
    }

    bool apart_at(double share, double half, double margin) {
      place(share);
      for (std::size_t i = 0; i < phase_.bodies_.size(); ++i) {
        if (!phase_.bodies_[i].phase->apart_throughout(motions_.of_body[i], half, margin)) return false;
      }
      for (std::size_t p = 0; p < phase_.pairs_.size(); ++p) {
        const Pair& pair = phase_.pairs_[p];
        if (phase_.gap(pair) > half * motions_.of_pair[p].displacement + margin) continue;
        if (!pair.phase->apart_throughout(seen(p), half, margin)) return false;
      }
      return true;
    }

    /// The motion of a pair in the frame of its second body, where that is now.
    [[nodiscard]] SeenMotion seen(std::size_t p) const {
      const Pair& pair = phase_.pairs_[p];
      const Quaternion back = phase_.poses_[pair.other].orientation.inverse();
      SeenMotion motion = motions_.of_pair[p];
      motion.pose = phase_.between(pair);
      motion.whole.translation = back(motion.whole.translation);
      motion.whole.axis = back(motion.whole.axis);
      return motion;
    }

    const TeamPhase& phase_;
    Motions motions_;
    View a_;
    View b_;
    double displacement_ = 0.0;
  };

  [[nodiscard]] static std::shared_ptr<const BodyPhase> phase_of(const World3& world, const Robot3& robot,
                                                                 bool filtered) {
    auto scene = std::make_shared<SpatialScene>(world, robot);
    const Space space = scene->default_space(1.0);
    return make_body_phase(std::move(scene), space, filtered);
  }

  /// The length of a body's row of `free_`.
  [[nodiscard]] std::size_t row() const { return n_ + std::size_t{1}; }
  /// Whether a body, at its current pose on the motion that has begun, touches an obstacle or leaves the boundary.
  /// \param index  of the configuration, 1..n
  /// \param gap_to_others  of its share from those of earlier levels of the bisection
  [[nodiscard]] bool body_touches(std::uint32_t index, double gap_to_others) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      char* free = free_.data() + i * row();
      if (free[index] != 0) continue;
      const double displacement = motions_->of_body[i].displacement;
      const double sure = bodies_[i].phase->sure_clearance(poses_[i], displacement * gap_to_others);
      if (sure < 0.0) return true;
      mark_free(free, n_, index, sure, displacement / n_);
    }
    return false;
  }

  void place(View q) const {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      poses_[i] = bodies_[i].member->robot->pose(bodies_[i].member->own(q));
    }
  }
  /// The distance between the bounding balls of two bodies, at most.
  [[nodiscard]] double gap(const Pair& pair) const {
    return norm(poses_[pair.body].position - poses_[pair.other].position) - pair.reach;
  }
  /// The pose of the first body in the frame of the second.
  [[nodiscard]] Pose3 between(const Pair& pair) const { return poses_[pair.other].inverse() * poses_[pair.body]; }
  [[nodiscard]] bool meet(const Pair& pair) const {
    return gap(pair) <= slack_ && !pair.phase->valid_at(between(pair));
  }

  std::shared_ptr<const Scene> scene_;
  const Robot3& robot_;
  Space space_;
  double slack_ = 0.0;
  std::vector<Body> bodies_;
  std::vector<Pair> pairs_;

  // The motion that has begun, or is certified.
  View a_;
  View b_;
  std::uint32_t n_ = 0;
  std::optional<Motions> motions_;
  std::vector<char> free_;         ///< by body and index: whether another configuration shows that the body is free
  std::vector<std::size_t> near_;  ///< pairs that are not apart from each other throughout
  std::optional<Clearances> clearances_;

  // Scratch.
  mutable std::vector<Pose3> poses_;  ///< of the bodies at the configuration placed last
  mutable Configuration q_;
};

}  // namespace

std::unique_ptr<NarrowPhase> make_team_phase(std::shared_ptr<const Scene> scene, const Space& space, bool filtered) {
  return std::make_unique<TeamPhase>(std::move(scene), space, filtered);
}

}  // namespace trellis
