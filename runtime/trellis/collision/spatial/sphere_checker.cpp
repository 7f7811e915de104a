// SPDX-License-Identifier: GPL-3.0-or-later
// The narrow phase of manipulators: balls among the obstacles of space, and against each other.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/common.hpp>
#include <trellis/collision/narrow_phase.hpp>
#include <trellis/collision/planar/kernel.hpp>
#include <trellis/collision/spatial/sphere_scene.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/obstacle_distance.hpp>

namespace trellis {

namespace {

class SpherePhase final : public NarrowPhase {
 public:
  SpherePhase(std::shared_ptr<const Scene> scene, const Space& space)
      : scene_(std::move(scene)),
        world_(scene_->manipulator()->world),
        model_(scene_->manipulator()->robot),
        robot_(model_.robot()),
        base_(scene_->manipulator()->robot.base()),
        space_(space),
        slack_(touching_slack(*scene_)),
        shared_(SphereScene::of(scene_, slack_)),
        obstacles_(&shared_->obstacles()),
        batched_(shared_->batched()),
        q_(space.dimension()),
        change_(space.dimension()) {
    for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
      // The base does not move: it is checked as the others, so that a base in an obstacle is found.
      if (!model_.bodies()[b].empty()) solid_.push_back(b);
    }
    if (const auto standing = model_.standing()) standing_gap_ = standing->gap;
    stands_in_contact_ = standing_gap_ <= slack_;
    sums_.resize(solid_.size());
    Configuration unit(space.dimension(), 0.0);
    for (double& x : unit) {
      x = 1.0;
      for (const std::size_t body : solid_) reach_.push_back(robot_.displacement_bound(body, unit));
      x = 0.0;
    }
    frames_.resize(model_.bodies().size());
    placed_.resize(model_.bodies().size());
    for (std::size_t b = 0; b < placed_.size(); ++b) placed_[b].resize(model_.bodies()[b].size());
    if (batched_) add_scratch();
  }

  [[nodiscard]] double displacement(View a, View b) const override {
    robot_.change(space_, a, b, change_);
    std::fill(sums_.begin(), sums_.end(), 0.0);
    const std::size_t bodies = sums_.size();
    for (std::size_t j = 0; j < change_.size(); ++j) {
      const double by = std::abs(change_[j]);
      const double* reach = &reach_[j * bodies];
      for (std::size_t k = 0; k < bodies; ++k) sums_[k] += by * reach[k];
    }
    double most = 0.0;
    for (const double sum : sums_) most = std::max(most, sum);
    return most;
  }

  Decision begin(View a, View b, std::uint32_t n) override {
    if (stands_in_contact_) return Decision::end_touches;
    a_ = a;
    b_ = b;
    n_ = n;
    // The end is the first configuration of a motion, and most invalid motions of a search end in contact.
    end_alone_ = batched_ && end_decides_.pays();
    if (end_alone_ && meets(b)) {
      note_decided_at(0);
      return Decision::end_touches;
    }
    return Decision::undecided;
  }

  Batch check(const Order& order, std::uint32_t rank) override {
    if (!batched_) {
      return one_by_one(rank, n_, [&](std::uint32_t at) {
        space_.interpolate(a_, b_, order.share(at), q_);
        return !free_at(q_);
      });
    }
    if (rank == 0 && end_alone_) {
      // Most of the motions whose ends are free touch something in the second configuration.
      const bool second_alone = n_ > 1 && second_decides_.pays();
      if (second_alone) {
        space_.interpolate(a_, b_, order.share(1), q_);
        if (meets(q_)) return {2, 2U};
      }
      const std::uint32_t alone = second_alone ? 2 : 1;
      if (n_ == alone) return {n_, 0};
    }
    for (std::uint32_t lane = 0; lane < kernel::lanes; ++lane) {
      space_.interpolate(a_, b_, order.share(rank + lane), q_);
      set_lane(lane);
    }
    const unsigned asked = first_lanes(n_ - rank);
    return {std::min(n_ - rank, kernel::lanes), met(asked) & asked};
  }

  std::optional<double> end(std::uint32_t first) override {
    if (batched_) note_decided_at(first);
    return std::nullopt;
  }

  bool sweep(View /*a*/, View /*b*/, Certificate& certificate) override {
    if (stands_in_contact_) {
      certificate.refuted_at = 0.0;
      return true;
    }
    certificate.nearest = std::min(certificate.nearest, standing_gap_);
    certificate.clearance = std::min(certificate.clearance, standing_gap_);
    return false;
  }

  Distances on(View a, View b, double longest) override {
    clearances_.emplace(*this, a, b);
    return {*clearances_, clearances_->displacement(),
            clearances_->batched() ? clearances_->first_of(longest) : longest};
  }

  [[nodiscard]] bool touches(View q) const override {
    return stands_in_contact_ || (batched_ ? meets(q) : !free_at(q));
  }

  [[nodiscard]] double clearance(View q) const override {
    place(q);
    const double found = std::min(distance_at(std::numeric_limits<double>::infinity(), nullptr), standing_gap_);
    return found <= slack_ ? 0.0 : found;
  }

  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) const override {
    if (world_.obstacles().empty()) return std::nullopt;
    place(q);
    Proximity found{0, std::numeric_limits<double>::infinity(), std::nullopt};
    const auto compare = [&](std::size_t obstacle, double distance) {
      if (distance < found.distance || (distance == found.distance && obstacle < found.obstacle)) {
        found = {obstacle, distance, std::nullopt};
      }
    };
    for (const std::size_t b : solid_) {
      for (std::size_t i = 1; i < placed_[b].size(); ++i) {
        const double r = model_.bodies()[b][i].radius;
        for (const Primitive& primitive : obstacles_->primitives) {
          compare(primitive.obstacle, primitive.distance(placed_[b][i]) - r);
        }
        for (const PlacedCloud& cloud : obstacles_->clouds) {
          // An obstacle as near as another one counts where it comes first.
          const double enough = std::nextafter(found.distance, std::numeric_limits<double>::infinity()) + r;
          compare(cloud.obstacle, cloud.distance(placed_[b][i], enough) - r);
        }
        if (!obstacles_->meshes) continue;
        const NearestObstacle near = obstacles_->meshes->nearest(placed_[b][i]);
        compare(obstacles_->of_mesh[near.obstacle], near.distance - r);
      }
    }
    if (found.distance <= slack_) found = {found.obstacle, 0.0, std::nullopt};
    return found;
  }

  [[nodiscard]] std::optional<Contact> contact(View q) const override {
    if (batched_ && !touches(q)) return std::nullopt;
    place(q);
    for (const std::size_t b : solid_) {
      if (margin_of(b) <= -slack_) return Contact{b, std::nullopt};
      std::optional<std::size_t> first;
      for (std::size_t i = 1; i < placed_[b].size(); ++i) {
        const double r = model_.bodies()[b][i].radius;
        for (const Primitive& primitive : obstacles_->primitives) {
          if (primitive.distance(placed_[b][i]) - r <= slack_)
            first = std::min(first.value_or(primitive.obstacle), primitive.obstacle);
        }
        for (const PlacedCloud& cloud : obstacles_->clouds) {
          if (cloud.distance(placed_[b][i], r + 2.0 * slack_) - r <= slack_)
            first = std::min(first.value_or(cloud.obstacle), cloud.obstacle);
        }
        if (!obstacles_->meshes) continue;
        const NearestObstacle near = obstacles_->meshes->nearest(placed_[b][i]);
        if (near.distance - r > slack_) continue;
        const std::size_t obstacle = obstacles_->of_mesh[near.obstacle];
        first = std::min(first.value_or(obstacle), obstacle);
      }
      if (first) return Contact{b, first};
    }
    const auto itself = [&](std::size_t one, std::size_t other) {
      const auto& links = robot_.tree().links();
      return Contact{robot_.body_of(one), std::nullopt, robot_.body_of(other), links[one].name, links[other].name};
    };
    if (stands_in_contact_) return itself(model_.standing()->first, model_.standing()->second);
    for (const auto& [first, second] : model_.pairs()) {
      const SphereModel::Part& a = model_.parts()[first];
      const SphereModel::Part& b = model_.parts()[second];
      std::pair<std::size_t, std::size_t> balls;
      if (gap(a, b, std::numeric_limits<double>::infinity(), &balls) <= slack_) {
        return itself(model_.link_of(a.body, balls.first), model_.link_of(b.body, balls.second));
      }
    }
    return std::nullopt;
  }

 private:
  /// Allocates the memory of the kernels, and places the base.
  void add_scratch() {
    const std::size_t bodies = chain().size();
    values_.resize(robot_.dimension());
    rates_.resize(6 * bodies);
    frames3_.resize(12 * bodies);
    centres_.resize(3 * shared_->ball_count());
    scratch_.resize(shared_->scratch_count());
    one_.emplace(*shared_, BodyFrame{matrix_of(base_.orientation), base_.position});
    const Matrix3 base = matrix_of(base_.orientation);
    for (double& value : frames3_[9].v) value = base_.position.x;
    for (double& value : frames3_[10].v) value = base_.position.y;
    for (double& value : frames3_[11].v) value = base_.position.z;
    for (std::size_t k = 0; k < 9; ++k) {
      for (double& value : frames3_[k].v) value = base[k];
    }
  }
  /// Whether to check a configuration alone before it is checked with seven others: where it alone decided most of the
  /// last motions, as in searches, but not those of roadmaps and shortcuts.
  class Habit {
   public:
    [[nodiscard]] bool pays() const { return count_ >= most / 2; }
    void note(bool decided) { count_ = std::clamp(count_ + (decided ? 1 : -1), 0, most); }

   private:
    static constexpr int most = 16;
    int count_ = most;
  };
  /// Notes the first invalid configuration of a motion, by its rank.
  void note_decided_at(std::uint32_t rank) {
    end_decides_.note(rank == 0);
    if (rank > 0) second_decides_.note(rank == 1);
  }
  /// The frame at q of a body whose joint carries a whole robot.
  [[nodiscard]] BodyFrame root_frame(std::size_t body, View q) const {
    const BodyFrame base{matrix_of(base_.orientation), base_.position};
    const Pose3 pose = robot_.joint_pose(body, q);
    return {times(base.r, matrix_of(pose.orientation)), base(pose.position)};
  }
  /// Passes the configuration in `q_` to the kernels of eight.
  void set_lane(std::size_t lane) const {
    for (std::size_t j = 0; j < robot_.dimension(); ++j) values_[j].v[lane] = q_[j];
    for (const std::size_t body : shared_->roots()) {
      const BodyFrame frame = root_frame(body, q_);
      kernel::Lanes* to = &frames3_[12 * body];
      for (std::size_t k = 0; k < 9; ++k) to[k].v[lane] = frame.r[k];
      to[9].v[lane] = frame.p.x;
      to[10].v[lane] = frame.p.y;
      to[11].v[lane] = frame.p.z;
    }
  }
  /// What the kernels say of one configuration.
  [[nodiscard]] bool meets(View q) const {
    for (const std::size_t body : shared_->roots()) one_->set(body, root_frame(body, q));
    return kernel_.touches(chain().data(), static_cast<unsigned>(chain().size()), q.data(), shared_->kernel_scene(),
                           one_->get());
  }
  [[nodiscard]] const std::vector<kernel::ChainBody>& chain() const { return shared_->chain(); }
  /// The bits of the first lanes, at most of all.
  static unsigned first_lanes(std::size_t count) { return count >= kernel::lanes ? 0xffU : (1U << count) - 1U; }
  /// The lanes of `values_` in which the robot touches something.
  /// \param asked  lanes whose answer is needed
  [[nodiscard]] unsigned met(unsigned asked) const {
    const auto count = static_cast<unsigned>(chain().size());
    kernel::Scene3 scene = shared_->kernel_scene();
    scene.cloud_lanes = asked;
    kernel_.move_chain(chain().data(), count, values_.data(), frames3_.data());
    return kernel_.meet_chain(chain().data(), count, frames3_.data(), scene, centres_.data(), scratch_.data());
  }

  /// Computes the frames of all bodies at q.
  void move(View q) const {
    frames_[0] = {matrix_of(base_.orientation), base_.position};
    for (std::size_t b = 1; b < frames_.size(); ++b) {
      const Manipulator::Body& body = robot_.bodies()[b];
      const BodyFrame& parent = frames_[body.parent];
      BodyFrame& frame = frames_[b];
      const JointTurn& turn = shared_->turns()[b];
      if (body.is_root()) {
        const Pose3 pose = robot_.joint_pose(b, q);
        frame = {times(parent.r, matrix_of(pose.orientation)), parent(pose.position)};
        continue;
      }
      const double value = body.multiplier * q[body.column] + body.offset;
      if (body.kind == Joint::Kind::prismatic) {
        const Matrix3& o = turn.origin;
        const Vec3 along = value * body.axis;
        const Vec3 moved{o[0] * along.x + o[1] * along.y + o[2] * along.z,
                         o[3] * along.x + o[4] * along.y + o[5] * along.z,
                         o[6] * along.x + o[7] * along.y + o[8] * along.z};
        frame = {times(parent.r, turn.origin), parent(body.origin.position + moved)};
        continue;
      }
      const double sine = std::sin(value);
      const double rest = 1.0 - std::cos(value);
      Matrix3 local{};
      for (std::size_t k = 0; k < 9; ++k) local[k] = turn.origin[k] + sine * turn.once[k] + rest * turn.twice[k];
      frame = {times(parent.r, local), parent(body.origin.position)};
    }
  }

  /// Places the ball about each body.
  void place_wholes() const {
    for (const std::size_t b : solid_) placed_[b][0] = frames_[b](model_.bodies()[b][0].centre);
  }
  /// Places the balls of a body.
  void place_balls(std::size_t b) const {
    for (std::size_t i = 1; i < placed_[b].size(); ++i) placed_[b][i] = frames_[b](model_.bodies()[b][i].centre);
  }
  /// Places all balls at q.
  void place(View q) const {
    move(q);
    place_wholes();
    for (const std::size_t b : solid_) place_balls(b);
  }

  /// The distance of a body's balls from the obstacles, or `enough` where it is not less; at most 0 in contact.
  [[nodiscard]] double distance_of(std::size_t b, double enough) const {
    const auto& balls = model_.bodies()[b];
    double least = enough;
    for (const Primitive& primitive : obstacles_->primitives) {
      if (norm(placed_[b][0] - primitive.centre) - primitive.far - balls[0].radius >= least) continue;
      if (primitive.distance(placed_[b][0]) - balls[0].radius >= least) continue;
      for (std::size_t i = 1; i < balls.size(); ++i) {
        least = std::min(least, primitive.distance(placed_[b][i]) - balls[i].radius);
      }
    }
    for (const PlacedCloud& cloud : obstacles_->clouds) {
      const double whole = balls[0].radius;
      if (cloud.distance(placed_[b][0], least + whole) - whole >= least) continue;
      for (std::size_t i = 1; i < balls.size(); ++i) {
        least = std::min(least, cloud.distance(placed_[b][i], least + balls[i].radius) - balls[i].radius);
      }
    }
    if (obstacles_->meshes && (*obstacles_->meshes)(placed_[b][0]) - balls[0].radius < least) {
      for (std::size_t i = 1; i < balls.size(); ++i) {
        least = std::min(least, (*obstacles_->meshes)(placed_[b][i]) - balls[i].radius);
      }
    }
    return least;
  }

  /// A bound on how far the points of a body move from where it is placed, on a part of a motion to either side: the
  /// arms at which joints turn it are at most those of now, and what it moves by meanwhile.
  /// \param half  share of the motion to either side
  /// \param change  of the coordinates on the whole motion
  /// \param coarse  another bound
  [[nodiscard]] double displacement_near(std::size_t body, double half, View change, double coarse) const {
    const Vec3& centre = placed_[body][0];
    const double radius = model_.bodies()[body][0].radius;
    double sum = 0.0;
    for (std::size_t at = body; at != 0; at = robot_.bodies()[at].parent) {
      const Manipulator::Body& joint = robot_.bodies()[at];
      if (joint.is_root()) return coarse;
      const double by = half * std::abs(joint.multiplier * change[joint.column]);
      if (by == 0.0) continue;
      if (joint.kind == Joint::Kind::prismatic) {
        sum += by;
        continue;
      }
      const Matrix3& r = frames_[at].r;
      const Vec3& a = joint.axis;
      const Vec3 axis{r[0] * a.x + r[1] * a.y + r[2] * a.z, r[3] * a.x + r[4] * a.y + r[5] * a.z,
                      r[6] * a.x + r[7] * a.y + r[8] * a.z};
      sum += by * (norm(cross(axis, centre - frames_[at].p)) + radius + 2.0 * coarse);
    }
    return std::min(sum, coarse);
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

  /// The distance of two parts, or `enough` where it is not less.
  /// \param nearest  receives the balls that are nearest to each other
  [[nodiscard]] double gap(const SphereModel::Part& a, const SphereModel::Part& b, double enough,
                           std::pair<std::size_t, std::size_t>* nearest = nullptr) const {
    const auto& first = model_.bodies()[a.body];
    const auto& second = model_.bodies()[b.body];
    const std::vector<Vec3>& one = placed_[a.body];
    const std::vector<Vec3>& two = placed_[b.body];
    double least = enough;
    if (norm(one[0] - two[0]) - first[0].radius - second[0].radius >= least) return least;
    const Vec3 whole = frames_[b.body](b.whole.centre);
    if (norm(frames_[a.body](a.whole.centre) - whole) - a.whole.radius - b.whole.radius >= least) return least;
    for (std::size_t i = a.begin; i < a.end; ++i) {
      if (norm(one[i] - whole) - first[i].radius - b.whole.radius >= least) continue;
      for (std::size_t j = b.begin; j < b.end; ++j) {
        const double found = norm(one[i] - two[j]) - first[i].radius - second[j].radius;
        if (found >= least) continue;
        least = found;
        if (nearest != nullptr) *nearest = {i, j};
      }
    }
    return least;
  }
  /// As above, for a pair of the model.
  [[nodiscard]] double gap(const std::pair<std::size_t, std::size_t>& pair, double enough) const {
    return gap(model_.parts()[pair.first], model_.parts()[pair.second], enough);
  }

  [[nodiscard]] bool free_at(View q) const {
    move(q);
    place_wholes();
    // Contact is likelier far from the base.
    for (std::size_t k = solid_.size(); k-- > 0;) {
      const std::size_t b = solid_[k];
      place_balls(b);
      if (margin_of(b) <= -slack_ || distance_of(b, 2.0 * slack_) <= slack_) return false;
    }
    return std::all_of(model_.pairs().begin(), model_.pairs().end(),
                       [&](const auto& pair) { return gap(pair, 2.0 * slack_) > slack_; });
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
      const double enough = std::max(least, certain + by);
      if (const double found = distance_of(b, enough); found < enough) note(found, by);
    }
    for (const auto& pair : model_.pairs()) {
      const double by = moved != nullptr ? displacement_of(pair, *moved) : 0.0;
      const double enough = std::max(least, certain + by);
      if (const double found = gap(pair, enough); found < enough) note(found, by);
    }
    if (sure != nullptr) *sure = certain;
    return least;
  }

  /// Whether everything is farther from the robot, whose wholes are placed, than `margin` and the displacements.
  [[nodiscard]] bool apart_by(double margin, const std::vector<double>& moved) const {
    for (std::size_t k = solid_.size(); k-- > 0;) {
      const std::size_t b = solid_[k];
      place_balls(b);
      const double by = margin + moved[b];
      if (margin_of(b) <= by || distance_of(b, std::nextafter(by, 2.0 * by)) <= by) return false;
    }
    return std::all_of(model_.pairs().begin(), model_.pairs().end(), [&](const auto& pair) {
      const double by = margin + displacement_of(pair, moved);
      return gap(pair, std::nextafter(by, 2.0 * by)) > by;
    });
  }
  /// How far the bodies of a pair move together.
  [[nodiscard]] double displacement_of(const std::pair<std::size_t, std::size_t>& pair,
                                       const std::vector<double>& moved) const {
    return moved[model_.parts()[pair.first].body] + moved[model_.parts()[pair.second].body];
  }

  /// The distances on a motion.
  class Clearances final : public MotionClearance {
   public:
    Clearances(const SpherePhase& phase, View a, View b)
        : phase_(phase),
          a_(a),
          b_(b),
          whole_(phase.model_.bodies().size(), 0.0),
          moved_(whole_.size()),
          change_(phase.space_.dimension()) {
      phase.robot_.change(phase.space_, a, b, change_);
      for (const std::size_t body : phase.solid_) {
        whole_[body] = phase.shared_->longest_path(body, change_);
        displacement_ = std::max(displacement_, whole_[body]);
      }
      batched_ = phase.batched_ && add_roots();
      if (!batched_) return;
      bend_.assign(whole_.size(), 0.0);
      for (const std::size_t body : phase.solid_) {
        bend_[body] = phase.shared_->bend(body, phase.shared_->levers()[body].size(), change_);
      }
      pair_bend_.resize(phase.shared_->unshared().size());
      for (std::size_t p = 0; p < pair_bend_.size(); ++p) {
        const auto& [first, second] = phase.model_.pairs()[p];
        const auto& [own, other] = phase.shared_->unshared()[p];
        pair_bend_[p] = phase.shared_->bend(phase.model_.parts()[first].body, own, change_) +
                        phase.shared_->bend(phase.model_.parts()[second].body, other, change_);
      }
      part_change_.resize(change_.size());
      part_bend_.resize(bend_.size());
      part_pair_bend_.resize(pair_bend_.size());
    }
    [[nodiscard]] double displacement() const { return displacement_; }
    [[nodiscard]] bool batched() const { return batched_; }
    /// The length of the first intervals, so that whole calls of the kernels decide them. The displacement is bounded
    /// as if all joints turned the robot in one direction, at its full length; the kernels bound it more closely.
    [[nodiscard]] double first_of(double longest) const {
      constexpr double overestimated = 4.0;
      const double calls = std::max(std::ceil(displacement_ / (overestimated * longest * lanes)), 1.0);
      // A little more, for rounding.
      return std::max(1.000001 * displacement_ / (calls * lanes), std::numeric_limits<double>::min());
    }

    [[nodiscard]] unsigned apart(std::span<const double> shares, double half, double margin) override {
      if (!batched_) {
        unsigned found = 0;
        for (std::size_t i = 0; i < shares.size(); ++i) {
          place(shares[i], half);
          if (phase_.apart_by(margin + phase_.slack_, moved_)) found |= 1U << i;
        }
        return found;
      }
      const kernel::ChainMotion motion = move(shares, half);
      kernel::Scene3 scene = phase_.shared_->kernel_scene();
      scene.slack = margin + phase_.slack_;
      scene.cloud_lanes = first_lanes(shares.size());
      const unsigned near = phase_.kernel_.approach_chain(
          phase_.chain().data(), static_cast<unsigned>(phase_.chain().size()), phase_.frames3_.data(),
          phase_.rates_.data(), scene, motion, phase_.centres_.data(), phase_.scratch_.data());
      return ~near & ((1U << shares.size()) - 1U);
    }
    [[nodiscard]] std::optional<double> measured_from() const override {
      return batched_ ? std::optional(measured_from_share) : std::nullopt;
    }
    [[nodiscard]] Near near(double share, double half, double at_most) override {
      if (batched_) return near_of_batch(share, half, at_most);
      place(share, half);
      for (const std::size_t b : phase_.solid_) phase_.place_balls(b);
      double sure = 0.0;
      const double distance = phase_.distance_at(at_most + 2.0 * half * displacement_, &moved_, &sure);
      if (distance <= phase_.slack_) return {0.0, std::min(sure, 0.0)};
      // The displacements of an arm are bounded coarsely: shorter intervals for a closer bound would cost more than the
      // search.
      return {std::min(distance, at_most), std::min(sure - phase_.slack_, at_most), true};
    }

   private:
    /// Distances at eight configurations cost twice as much as what `apart` says of them.
    static constexpr double measured_from_share = 2.0;

    /// Computes how the joints that carry whole robots turn and slide on the whole motion, in the world.
    /// \return whether they turn by less than a half turn: of that, rounding decides the direction
    bool add_roots() {
      for (const std::size_t body : phase_.shared_->roots()) {
        const Manipulator::Body& root = phase_.robot_.bodies()[body];
        const Quaternion frame = (phase_.base_ * root.origin).orientation;
        const Pose3 back = root.origin.inverse();
        const Pose3 from = back * phase_.robot_.joint_pose(body, a_);
        const Pose3 to = back * phase_.robot_.joint_pose(body, b_);
        Vec3 turn;
        if (root.kind == Joint::Kind::planar) turn = change_[root.column + 2] * root.axis;
        if (root.kind == Joint::Kind::floating) {
          turn = rotation_vector(to.orientation * from.orientation.inverse());
          constexpr double half_turn = 3.141;
          if (norm(turn) > half_turn) return false;
        }
        roots_.emplace_back(frame(turn), frame(to.position - from.position));
      }
      return true;
    }
    /// Places the robot at eight configurations, and bounds how it moves to either side of each.
    kernel::ChainMotion move(std::span<const double> shares, double half) {
      shares_.fill(std::numeric_limits<double>::quiet_NaN());
      std::copy(shares.begin(), shares.end(), shares_.begin());
      half_ = half;
      measured_ = false;
      for (std::size_t lane = 0; lane < kernel::lanes; ++lane) {
        phase_.space_.interpolate(a_, b_, shares[std::min(lane, shares.size() - 1)], phase_.q_);
        phase_.set_lane(lane);
      }
      for (std::size_t r = 0; r < roots_.size(); ++r) {
        const auto& [turn, slide] = roots_[r];
        const std::array<double, 6> rates = {turn.x, turn.y, turn.z, slide.x, slide.y, slide.z};
        kernel::Lanes* to = &phase_.rates_[6 * phase_.shared_->roots()[r]];
        for (std::size_t k = 0; k < rates.size(); ++k) {
          for (double& value : to[k].v) value = half * rates[k];
        }
      }
      for (std::size_t j = 0; j < change_.size(); ++j) part_change_[j] = half * change_[j];
      for (std::size_t b = 0; b < bend_.size(); ++b) part_bend_[b] = half * half * bend_[b];
      for (std::size_t p = 0; p < pair_bend_.size(); ++p) part_pair_bend_[p] = half * half * pair_bend_[p];
      const auto count = static_cast<unsigned>(phase_.chain().size());
      phase_.kernel_.move_chain(phase_.chain().data(), count, phase_.values_.data(), phase_.frames3_.data());
      phase_.kernel_.rate_chain(phase_.chain().data(), count, phase_.frames3_.data(), part_change_.data(),
                                phase_.rates_.data());
      return part();
    }
    [[nodiscard]] kernel::ChainMotion part() const {
      return {part_change_.data(), part_bend_.data(), part_pair_bend_.data()};
    }
    /// The distance at one of the configurations that `apart` decided last, or at another one; those of all eight are
    /// computed at once.
    [[nodiscard]] Near near_of_batch(double share, double half, double at_most) {
      const auto* found = std::find(shares_.begin(), shares_.end(), share);
      if (found == shares_.end() || half != half_) {
        static_cast<void>(move(std::span(&share, 1), half));
        found = shares_.begin();
      }
      if (!measured_) {
        const double most = at_most + 2.0 * half * displacement_;
        for (std::size_t lane = 0; lane < kernel::lanes; ++lane) least_.v[lane] = sure_.v[lane] = most;
        phase_.kernel_.measure_chain(phase_.chain().data(), static_cast<unsigned>(phase_.chain().size()),
                                     phase_.frames3_.data(), phase_.rates_.data(), phase_.shared_->kernel_scene(),
                                     part(), phase_.centres_.data(), phase_.scratch_.data(), least_, sure_);
        measured_ = true;
      }
      const auto lane = static_cast<std::size_t>(found - shares_.begin());
      const double sure = sure_.v[lane] - phase_.slack_;
      if (least_.v[lane] <= phase_.slack_) return {0.0, std::min(sure, 0.0)};
      return {std::min(least_.v[lane], at_most), std::min(sure, at_most)};
    }

    /// Places the robot, and bounds how far its bodies move to either side.
    void place(double share, double half) {
      phase_.space_.interpolate(a_, b_, share, phase_.q_);
      phase_.move(phase_.q_);
      phase_.place_wholes();
      for (const std::size_t b : phase_.solid_) {
        moved_[b] = phase_.displacement_near(b, half, change_, half * whole_[b]);
      }
    }

    const SpherePhase& phase_;
    View a_;
    View b_;
    std::vector<double> whole_;  ///< of each body, on the whole motion
    std::vector<double> moved_;
    Configuration change_;  ///< of the coordinates on the whole motion
    double displacement_ = 0.0;
    bool batched_ = false;  ///< whether the kernels decide
    // For the kernels.
    std::vector<std::pair<Vec3, Vec3>> roots_;  ///< of each of SphereScene::roots: how it turns and slides
    std::vector<double> bend_;  ///< of each body on the whole motion to either side; grows as the motion's square
    std::vector<double> pair_bend_;
    std::vector<double> part_change_, part_bend_, part_pair_bend_;  ///< of the part of the last call
    std::array<double, lanes> shares_{};                            ///< of the last call; NaN: no configuration
    double half_ = -1.0;
    bool measured_ = false;  ///< whether the next two are of these configurations
    kernel::Lanes least_{}, sure_{};
  };

  std::shared_ptr<const Scene> scene_;
  const World3& world_;
  const SphereModel& model_;
  const Manipulator& robot_;
  Pose3 base_;
  Space space_;
  double slack_;
  std::shared_ptr<const SphereScene> shared_;
  const SolidObstacles* obstacles_;
  std::vector<std::size_t> solid_;                                 ///< bodies with balls
  bool batched_ = false;                                           ///< whether the kernels decide
  double standing_gap_ = std::numeric_limits<double>::infinity();  ///< of links that do not move against each other
  bool stands_in_contact_ = false;                                 ///< such links touch: no configuration is valid
  const kernel::Table& kernel_ = kernel::best();
  // The motion that has begun, or is certified.
  View a_;
  View b_;
  std::uint32_t n_ = 0;
  bool end_alone_ = false;  ///< `begin` has checked its end
  std::optional<Clearances> clearances_;
  // Scratch.
  mutable Configuration q_;
  mutable Configuration change_;
  std::vector<double> reach_;         ///< how far a coordinate moves each of solid_ at most, per unit; by coordinates
  mutable std::vector<double> sums_;  ///< of each of solid_
  mutable std::vector<kernel::Lanes> values_;
  mutable std::vector<kernel::Lanes> frames3_;
  mutable std::vector<kernel::Lanes> rates_;
  mutable std::vector<kernel::Lanes> centres_;
  mutable std::vector<unsigned> scratch_;
  mutable std::optional<ConfigurationMemory> one_;
  Habit end_decides_;
  Habit second_decides_;                           ///< of the motions whose ends are valid
  mutable std::vector<BodyFrame> frames_;          ///< of each body in the world
  mutable std::vector<std::vector<Vec3>> placed_;  ///< the centres of each body's balls
};

}  // namespace

std::unique_ptr<Checker> make_sphere_checker(std::shared_ptr<const Scene> scene, const Space& space,
                                             double resolution) {
  check_fits(*scene, space, resolution);
  const Scene& checked = *scene;
  return std::make_unique<Checker>(checked, std::make_unique<SpherePhase>(std::move(scene), space), resolution);
}

}  // namespace trellis
