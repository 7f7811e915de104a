// SPDX-License-Identifier: GPL-3.0-or-later
// The checker of manipulators: balls among the obstacles of space, and against each other.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/collision/common.hpp>
#include <trellis/collision/orders.hpp>
#include <trellis/collision/planar/kernel.hpp>
#include <trellis/scene/cache_by_world.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/obstacle_distance.hpp>

namespace trellis {

namespace {

/// A rotation as a matrix, row by row, and a position.
struct BodyFrame {
  std::array<double, 9> r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  Vec3 p;

  [[nodiscard]] Vec3 operator()(const Vec3& v) const {
    return {r[0] * v.x + r[1] * v.y + r[2] * v.z + p.x, r[3] * v.x + r[4] * v.y + r[5] * v.z + p.y,
            r[6] * v.x + r[7] * v.y + r[8] * v.z + p.z};
  }
};

using Matrix3 = std::array<double, 9>;

Matrix3 times(const Matrix3& a, const Matrix3& b) {
  Matrix3 c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    }
  }
  return c;
}

Matrix3 matrix_of(const Quaternion& q) {
  const Vec3 x = q({1, 0, 0});
  const Vec3 y = q({0, 1, 0});
  const Vec3 z = q({0, 0, 1});
  return {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z};
}

/// A convex obstacle, whose distance is computed at once.
struct Primitive {
  enum class Kind : std::uint8_t { sphere, box, cylinder, capsule };
  Kind kind = Kind::sphere;
  Matrix3 r{};  ///< from the world to its frame
  Vec3 centre;
  Vec3 half;  ///< of a box
  double radius = 0.0;
  double length = 0.0;  ///< half of it
  double far = 0.0;     ///< radius of a ball about the centre that contains it
  std::size_t obstacle = 0;

  /// The distance of a point from its surface outside, 0 inside.
  [[nodiscard]] double distance(const Vec3& at) const {
    const Vec3 d = at - centre;
    if (kind == Kind::sphere) return std::max(norm(d) - radius, 0.0);
    const Vec3 u{r[0] * d.x + r[1] * d.y + r[2] * d.z, r[3] * d.x + r[4] * d.y + r[5] * d.z,
                 r[6] * d.x + r[7] * d.y + r[8] * d.z};
    switch (kind) {
      case Kind::box:
        return norm({std::max(std::abs(u.x) - half.x, 0.0), std::max(std::abs(u.y) - half.y, 0.0),
                     std::max(std::abs(u.z) - half.z, 0.0)});
      case Kind::cylinder: {
        const double across = std::max(std::sqrt(u.x * u.x + u.y * u.y) - radius, 0.0);
        const double along = std::max(std::abs(u.z) - length, 0.0);
        return std::sqrt(across * across + along * along);
      }
      default: {
        const double along = std::max(std::abs(u.z) - length, 0.0);
        return std::max(std::sqrt(u.x * u.x + u.y * u.y + along * along) - radius, 0.0);
      }
    }
  }
};

Primitive primitive_of(const Solid& solid, std::size_t obstacle) {
  Primitive made;
  made.r = matrix_of(solid.pose.orientation.inverse());
  made.centre = solid.pose.position;
  made.obstacle = obstacle;
  made.far = farthest_from_origin({solid.shape, {}});
  if (const auto* sphere = std::get_if<Sphere>(&solid.shape)) {
    made.radius = sphere->radius;
  } else if (const auto* box = std::get_if<Cuboid>(&solid.shape)) {
    made.kind = Primitive::Kind::box;
    made.half = 0.5 * box->size;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&solid.shape)) {
    made.kind = Primitive::Kind::cylinder;
    made.radius = cylinder->radius;
    made.length = 0.5 * cylinder->length;
  } else if (const auto* capsule = std::get_if<Capsule>(&solid.shape)) {
    made.kind = Primitive::Kind::capsule;
    made.radius = capsule->radius;
    made.length = 0.5 * capsule->length;
  } else {
    throw Fault("a mesh is no primitive");
  }
  return made;
}

/// The obstacles of a world: those that are primitives, and the meshes.
struct SolidObstacles {
  std::vector<Primitive> primitives;
  std::optional<ObstacleDistance> meshes;
  std::vector<std::size_t> of_mesh;  ///< for each mesh its obstacle
};

/// What all checkers of a world share.
std::shared_ptr<const SolidObstacles> obstacles_in(const World3& world) {
  static CacheByWorld<SolidObstacles> cache;
  return cache.get(world, [](const World3& of) {
    SolidObstacles all;
    std::vector<Solid> meshes;
    for (std::size_t i = 0; i < of.obstacles().size(); ++i) {
      const Solid& solid = of.obstacles()[i].solid;
      if (std::holds_alternative<std::shared_ptr<const Mesh>>(solid.shape)) {
        meshes.push_back(solid);
        all.of_mesh.push_back(i);
      } else {
        all.primitives.push_back(primitive_of(solid, i));
      }
    }
    if (!meshes.empty()) all.meshes.emplace(meshes, of.surface());
    return all;
  });
}

/// A body's joint: its frame is that of its parent times origin + sin * once + (1 - cos) * twice.
struct JointTurn {
  Matrix3 origin{};
  Matrix3 once{};
  Matrix3 twice{};
};

class SphereChecker final : public Checker {
 public:
  SphereChecker(std::shared_ptr<const Scene> scene, const Space& space, double resolution)
      : scene_(std::move(scene)),
        world_(scene_->manipulator()->world),
        model_(scene_->manipulator()->robot),
        robot_(model_.robot()),
        base_(scene_->manipulator()->robot.base()),
        space_(space),
        resolution_(resolution),
        slack_(touching_slack(*scene_)),
        obstacles_(obstacles_in(world_)),
        q_(space.dimension()),
        change_(space.dimension()) {
    check_fits(*scene_, space, resolution);
    for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
      // The base does not move: it is checked as the others, so that a base in an obstacle is found.
      if (!model_.bodies()[b].empty()) solid_.push_back(b);
    }
    frames_.resize(model_.bodies().size());
    for (const Manipulator::Body& body : robot_.bodies()) {
      const Vec3& a = body.axis;
      const Matrix3 skew = {0, -a.z, a.y, a.z, 0, -a.x, -a.y, a.x, 0};
      const Matrix3 origin = matrix_of(body.origin.orientation);
      const Matrix3 once = times(origin, skew);
      turns_.push_back({origin, once, times(once, skew)});
    }
    placed_.resize(model_.bodies().size());
    for (std::size_t b = 0; b < placed_.size(); ++b) placed_[b].resize(model_.bodies()[b].size());
    make_batches();
  }

  [[nodiscard]] bool valid(View q) const override {
    if (!is_finite(q, robot_.dimension())) return false;
    if (!batched_) return free_at(q);
    for (std::size_t j = 0; j < robot_.dimension(); ++j) {
      for (double& value : values_[j].v) value = q[j];
    }
    return (met() & 1U) == 0;
  }

  [[nodiscard]] MotionReport motion(View a, View b) const override {
    if (!is_finite(a, robot_.dimension()) || !is_finite(b, robot_.dimension())) return {false, 1, 1.0};
    const std::uint32_t n = configurations_of(displacement(a, b), resolution_);
    const Order& order = order_of(n);
    const MotionReport valid{true, n, std::numeric_limits<double>::quiet_NaN()};
    if (!batched_) {
      for (std::uint32_t rank = 0; rank < n; ++rank) {
        const double share = order.share(rank);
        space_.interpolate(a, b, share, q_);
        if (!free_at(q_)) return {false, rank + 1, share};
      }
      return valid;
    }
    for (std::uint32_t rank = 0; rank < n; rank += kernel::lanes) {
      for (std::uint32_t lane = 0; lane < kernel::lanes; ++lane) {
        space_.interpolate(a, b, order.share(rank + lane), q_);
        for (std::size_t j = 0; j < robot_.dimension(); ++j) values_[j].v[lane] = q_[j];
      }
      const unsigned hit = met();
      if (hit == 0) continue;
      const auto first = rank + static_cast<std::uint32_t>(std::countr_zero(hit));
      if (first < n) return {false, first + 1, order.share(first)};
    }
    return valid;
  }

  void certify(View a, View b, Certificate& certificate) const override {
    if (!is_finite(a, robot_.dimension()) || !is_finite(b, robot_.dimension())) {
      certificate.refuted_at = is_finite(a, robot_.dimension()) ? 1.0 : 0.0;
      return;
    }
    Clearances motion(*this, a, b);
    const double first =
        std::isfinite(certificate.nearest) ? std::max(resolution_, 2.0 * certificate.nearest) : resolution_;
    add_motion(certificate, motion, motion.displacement(), first);
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
        if (!obstacles_->meshes) continue;
        const NearestObstacle near = obstacles_->meshes->nearest(placed_[b][i]);
        compare(obstacles_->of_mesh[near.obstacle], near.distance - r);
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
        const double r = model_.bodies()[b][i].radius;
        for (const Primitive& primitive : obstacles_->primitives) {
          if (primitive.distance(placed_[b][i]) - r <= slack_)
            first = std::min(first.value_or(primitive.obstacle), primitive.obstacle);
        }
        if (!obstacles_->meshes) continue;
        const NearestObstacle near = obstacles_->meshes->nearest(placed_[b][i]);
        if (near.distance - r > slack_) continue;
        const std::size_t obstacle = obstacles_->of_mesh[near.obstacle];
        first = std::min(first.value_or(obstacle), obstacle);
      }
      if (first) return Contact{b, first};
    }
    for (const auto& [a, b] : model_.pairs()) {
      if (gap(a, b, std::numeric_limits<double>::infinity()) <= slack_) return Contact{a, std::nullopt, b};
    }
    return std::nullopt;
  }

 private:
  /// Prepares what the kernels read.
  void make_batches() {
    const auto& bodies = robot_.bodies();
    batched_ = !obstacles_->meshes && std::none_of(bodies.begin(), bodies.end(), [](const Manipulator::Body& body) {
      return body.kind == Joint::Kind::planar;
    });
    if (!batched_) return;
    unsigned centres = 0;
    for (const auto& balls : model_.bodies()) {
      for (const BodySphere& ball : balls) balls_.push_back({ball.centre.x, ball.centre.y, ball.centre.z, ball.radius});
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Manipulator::Body& body = bodies[b];
      kernel::ChainBody& made = chain_.emplace_back();
      made.parent = static_cast<unsigned>(body.parent);
      made.slides = body.kind == Joint::Kind::prismatic;
      made.column = static_cast<unsigned>(body.column);
      made.multiplier = body.multiplier;
      made.offset = body.offset;
      std::copy(turns_[b].origin.begin(), turns_[b].origin.end(), made.origin);
      std::copy(turns_[b].once.begin(), turns_[b].once.end(), made.once);
      std::copy(turns_[b].twice.begin(), turns_[b].twice.end(), made.twice);
      const Vec3 axis = BodyFrame{turns_[b].origin, {}}(body.axis);
      const Vec3& p = body.origin.position;
      made.position[0] = p.x;
      made.position[1] = p.y;
      made.position[2] = p.z;
      made.axis[0] = axis.x;
      made.axis[1] = axis.y;
      made.axis[2] = axis.z;
      made.balls = balls_.data() + centres;
      made.ball_count = static_cast<unsigned>(model_.bodies()[b].size());
      made.first_centre = centres;
      centres += made.ball_count;
    }
    for (const Primitive& primitive : obstacles_->primitives) {
      kernel::Solid3& made = solids_.emplace_back();
      made.kind = static_cast<kernel::Solid3::Kind>(primitive.kind);
      std::copy(primitive.r.begin(), primitive.r.end(), made.r);
      made.x = primitive.centre.x;
      made.y = primitive.centre.y;
      made.z = primitive.centre.z;
      made.hx = primitive.half.x;
      made.hy = primitive.half.y;
      made.hz = primitive.half.z;
      made.radius = primitive.radius;
      made.length = primitive.length;
      made.far = primitive.far;
    }
    for (const auto& [a, b] : model_.pairs()) {
      pairs_.push_back(static_cast<unsigned>(a));
      pairs_.push_back(static_cast<unsigned>(b));
    }
    scene3_.solids = solids_.data();
    scene3_.solid_count = static_cast<unsigned>(solids_.size());
    scene3_.pairs = pairs_.data();
    scene3_.pair_count = static_cast<unsigned>(model_.pairs().size());
    scene3_.slack = slack_;
    still_.assign(bodies.size(), 0.0);
    scene3_.moved = still_.data();
    scene3_.bounded = world_.contain() == Contain::robot;
    const auto& [lo, hi] = world_.bounds();
    for (unsigned k = 0; k < 3; ++k) {
      scene3_.lo[k] = k == 0 ? lo.x : k == 1 ? lo.y : lo.z;
      scene3_.hi[k] = k == 0 ? hi.x : k == 1 ? hi.y : hi.z;
    }
    values_.resize(robot_.dimension());
    frames3_.resize(12 * bodies.size());
    centres_.resize(std::size_t{3} * centres);
    candidates_.resize(solids_.size() + 1);
    const Matrix3 base = matrix_of(base_.orientation);
    for (double& value : frames3_[9].v) value = base_.position.x;
    for (double& value : frames3_[10].v) value = base_.position.y;
    for (double& value : frames3_[11].v) value = base_.position.z;
    for (std::size_t k = 0; k < 9; ++k) {
      for (double& value : frames3_[k].v) value = base[k];
    }
  }
  /// The lanes of `values_` in which the robot touches something.
  [[nodiscard]] unsigned met() const { return met(scene3_); }
  [[nodiscard]] unsigned met(const kernel::Scene3& scene) const {
    const auto count = static_cast<unsigned>(chain_.size());
    kernel_.move_chain(chain_.data(), count, values_.data(), frames3_.data());
    return kernel_.meet_chain(chain_.data(), count, frames3_.data(), scene, centres_.data(), candidates_.data());
  }

  /// A bound on how far the robot's points move from a to b.
  [[nodiscard]] double displacement(View a, View b) const {
    space_.difference(a, b, change_);
    double most = 0.0;
    for (const std::size_t body : solid_) most = std::max(most, robot_.displacement_bound(body, change_));
    return most;
  }

  /// Computes the frames of all bodies at q.
  void move(View q) const {
    frames_[0] = {matrix_of(base_.orientation), base_.position};
    for (std::size_t b = 1; b < frames_.size(); ++b) {
      const Manipulator::Body& body = robot_.bodies()[b];
      const BodyFrame& parent = frames_[body.parent];
      BodyFrame& frame = frames_[b];
      const JointTurn& turn = turns_[b];
      if (body.kind == Joint::Kind::planar) {
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
      if (joint.kind == Joint::Kind::planar) return coarse;
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
    move(q);
    place_wholes();
    // Contact is likelier far from the base.
    for (std::size_t k = solid_.size(); k-- > 0;) {
      const std::size_t b = solid_[k];
      place_balls(b);
      if (margin_of(b) <= -slack_ || distance_of(b, 2.0 * slack_) <= slack_) return false;
    }
    return std::all_of(model_.pairs().begin(), model_.pairs().end(),
                       [&](const auto& pair) { return gap(pair.first, pair.second, 2.0 * slack_) > slack_; });
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
    for (const auto& [a, b] : model_.pairs()) {
      const double by = moved != nullptr ? (*moved)[a] + (*moved)[b] : 0.0;
      const double enough = std::max(least, certain + by);
      if (const double found = gap(a, b, enough); found < enough) note(found, by);
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
      const double by = margin + moved[pair.first] + moved[pair.second];
      return gap(pair.first, pair.second, std::nextafter(by, 2.0 * by)) > by;
    });
  }

  /// The distances on a motion.
  class Clearances final : public MotionClearance {
   public:
    Clearances(const SphereChecker& checker, View a, View b)
        : checker_(checker),
          a_(a),
          b_(b),
          whole_(checker.model_.bodies().size(), 0.0),
          moved_(whole_.size()),
          change_(checker.space_.dimension()) {
      checker.space_.difference(a, b, change_);
      for (const std::size_t body : checker.solid_) {
        whole_[body] = checker.robot_.displacement_bound(body, change_);
        displacement_ = std::max(displacement_, whole_[body]);
      }
    }
    [[nodiscard]] double displacement() const { return displacement_; }

    [[nodiscard]] unsigned apart(std::span<const double> shares, double half, double margin) override {
      if (!checker_.batched_) {
        unsigned found = 0;
        for (std::size_t i = 0; i < shares.size(); ++i) {
          place(shares[i], half);
          if (checker_.apart_by(margin + checker_.slack_, moved_)) found |= 1U << i;
        }
        return found;
      }
      for (std::size_t lane = 0; lane < kernel::lanes; ++lane) {
        checker_.space_.interpolate(a_, b_, shares[std::min(lane, shares.size() - 1)], checker_.q_);
        for (std::size_t j = 0; j < checker_.values_.size(); ++j) checker_.values_[j].v[lane] = checker_.q_[j];
      }
      for (std::size_t b = 0; b < whole_.size(); ++b) moved_[b] = half * whole_[b];
      kernel::Scene3 scene = checker_.scene3_;
      scene.slack = margin + checker_.slack_;
      scene.moved = moved_.data();
      scene.all_lanes = true;
      return ~checker_.met(scene) & ((1U << shares.size()) - 1U);
    }
    [[nodiscard]] Near near(double share, double half, double at_most) override {
      place(share, half);
      for (const std::size_t b : checker_.solid_) checker_.place_balls(b);
      double sure = 0.0;
      const double distance = checker_.distance_at(at_most + 2.0 * half * displacement_, &moved_, &sure);
      if (distance <= checker_.slack_) return {0.0, std::min(sure, 0.0)};
      // The displacements of an arm are bounded coarsely: shorter intervals for a closer bound would cost more than the
      // search.
      return {std::min(distance, at_most), std::min(sure - checker_.slack_, at_most), true};
    }

   private:
    /// Places the robot, and bounds how far its bodies move to either side.
    void place(double share, double half) {
      checker_.space_.interpolate(a_, b_, share, checker_.q_);
      checker_.move(checker_.q_);
      checker_.place_wholes();
      for (const std::size_t b : checker_.solid_) {
        moved_[b] = checker_.displacement_near(b, half, change_, half * whole_[b]);
      }
    }

    const SphereChecker& checker_;
    View a_;
    View b_;
    std::vector<double> whole_;  ///< of each body, on the whole motion
    std::vector<double> moved_;
    Configuration change_;  ///< of the coordinates on the whole motion
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
  std::shared_ptr<const SolidObstacles> obstacles_;
  std::vector<JointTurn> turns_;    ///< of each body
  std::vector<std::size_t> solid_;  ///< bodies with balls
  // For the kernels, which decide eight configurations at a time; without meshes, and for a base that does not move.
  bool batched_ = false;
  const kernel::Table& kernel_ = kernel::best();
  std::vector<kernel::Ball> balls_;
  std::vector<kernel::ChainBody> chain_;
  std::vector<kernel::Solid3> solids_;
  std::vector<unsigned> pairs_;
  std::vector<double> still_;  ///< bodies that do not move further
  kernel::Scene3 scene3_;
  // Scratch.
  mutable Configuration q_;
  mutable Configuration change_;
  mutable std::vector<kernel::Lanes> values_;
  mutable std::vector<kernel::Lanes> frames3_;
  mutable std::vector<kernel::Lanes> centres_;
  mutable std::vector<unsigned> candidates_;
  mutable std::vector<BodyFrame> frames_;          ///< of each body in the world
  mutable std::vector<std::vector<Vec3>> placed_;  ///< the centres of each body's balls
};

}  // namespace

std::unique_ptr<Checker> make_sphere_checker(std::shared_ptr<const Scene> scene, const Space& space,
                                             double resolution) {
  return std::make_unique<SphereChecker>(std::move(scene), space, resolution);
}

}  // namespace trellis
