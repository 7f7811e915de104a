// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/collision/common.hpp>
#include <trellis/collision/narrow_phase.hpp>
#include <trellis/collision/planar/distance.hpp>
#include <trellis/collision/planar/planar_checker.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

using Vector3 = fcl::Vector3d;
using Transform3 = fcl::Transform3d;
using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

/// FCL's iterations have tolerances in metres, about 1e-6: a smaller world is enlarged by a power of two, which is
/// exact.
double scale_of(const World& world) {
  constexpr double least = 1.0;
  const double size = norm(world.bounds().hi - world.bounds().lo);
  return size < least ? std::exp2(std::ceil(std::log2(least / size)) + 3.0) : 1.0;
}

ConvexShape scaled_shape(ConvexShape shape, double scale) {
  if (auto* disc = std::get_if<Disc>(&shape)) return Disc{scale * disc->centre, scale * disc->radius};
  for (Vec2& v : std::get<Polygon>(shape).vertices) v = scale * v;
  return shape;
}

Transform3 transform(const Pose2& pose) {
  Transform3 result;
  result.matrix() << pose.c, -pose.s, 0.0, pose.x,  //
      pose.s, pose.c, 0.0, pose.y,                  //
      0.0, 0.0, 1.0, 0.0,                           //
      0.0, 0.0, 0.0, 1.0;
  return result;
}

/// A planar convex shape as FCL's solids. All of them are symmetric about the plane z = 0, so they collide where the
/// planar shapes do.
///  - A rectangle is a box and a disc a sphere: FCL has closed forms for boxes and spheres with each other, while
///    its iteration for cylinders stops with an error of about 1e-6.
///  - Any other polygon is a convex prism. For a prism and a sphere FCL would iterate too, but it has a closed form for
///    a sphere and a triangle: a flat mesh of the polygon's area represents it there.
struct Solid {
  Geometry geometry;
  Geometry flat;  ///< of a polygon that is not a rectangle
  Transform3 frame = Transform3::Identity();
  bool round = false;
  bool framed = false;  ///< frame is not the identity

  Solid(const ConvexShape& shape, double half_height, double slack) {
    if (const auto* disc = std::get_if<Disc>(&shape)) {
      geometry = std::make_shared<fcl::Sphered>(disc->radius + slack);
      frame.translation() = Vector3(disc->centre.x, disc->centre.y, 0.0);
      round = true;
      framed = disc->centre != Vec2{};
    } else {
      const auto& polygon = std::get<Polygon>(shape);
      if (!make_box(polygon, half_height, slack)) {
        make_prism(polygon, half_height);
        make_flat(polygon);
      }
    }
    geometry->computeLocalAABB();
  }

  [[nodiscard]] const fcl::CollisionGeometryd* facing(const Solid& other) const {
    return other.round && flat ? flat.get() : geometry.get();
  }

 private:
  bool make_box(const Polygon& polygon, double half_height, double slack) {
    const auto& v = polygon.vertices;
    if (v.size() != 4) return false;
    const Vec2 along = v[1] - v[0];
    const Vec2 across = v[3] - v[0];
    const double length = norm(along);
    const double width = norm(across);
    const double rounding = 1e-14 * (norm(v[0]) + length + width);
    if (std::abs(dot(along, across)) > rounding * std::min(length, width)) return false;
    if (norm(v[0] + v[2] - (v[1] + v[3])) > rounding) return false;
    geometry = std::make_shared<fcl::Boxd>(length + 2.0 * slack, width + 2.0 * slack, 2.0 * half_height);
    const Vec2 centre = 0.25 * (v[0] + v[1] + (v[2] + v[3]));
    frame = transform({centre.x, centre.y, along.x / length, along.y / length});
    framed = true;
    return true;
  }

  void make_prism(const Polygon& polygon, double half_height) {
    const auto count = static_cast<int>(polygon.vertices.size());
    auto vertices = std::make_shared<std::vector<Vector3>>();
    for (const double z : {-half_height, half_height}) {
      for (const Vec2 v : polygon.vertices) vertices->emplace_back(v.x, v.y, z);
    }
    // Faces are counter-clockwise seen from outside: number of vertices, then the vertices.
    auto faces = std::make_shared<std::vector<int>>();
    faces->push_back(count);
    for (int i = count - 1; i >= 0; --i) faces->push_back(i);
    faces->push_back(count);
    for (int i = 0; i < count; ++i) faces->push_back(count + i);
    for (int i = 0; i < count; ++i) {
      const int next = (i + 1) % count;
      faces->insert(faces->end(), {4, i, next, count + next, count + i});
    }
    geometry = std::make_shared<fcl::Convexd>(vertices, count + 2, faces);
  }

  void make_flat(const Polygon& polygon) {
    auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    const auto& v = polygon.vertices;
    mesh->beginModel();
    for (std::size_t i = 2; i < v.size(); ++i) {
      mesh->addTriangle(Vector3(v[0].x, v[0].y, 0.0), Vector3(v[i - 1].x, v[i - 1].y, 0.0),
                        Vector3(v[i].x, v[i].y, 0.0));
    }
    mesh->endModel();
    mesh->computeLocalAABB();
    flat = std::move(mesh);
  }
};

bool overlap(const Box2& a, const Box2& b) {
  return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y;
}

/// FCL among the parts of the world as prisms in a dynamic tree.
class FclPhase final : public NarrowPhase {
 public:
  FclPhase(std::shared_ptr<const PlanarScene> scene, Space space)
      : scene_(std::move(scene)), robot_(scene_->robot), space_(std::move(space)) {
    slack_ = touching_slack(*scene_);
    scale_ = scale_of(scene_->world);
    const auto& world = scene_->world;
    // The robot is lower than the obstacles: with prisms of one height, FCL's iteration produces degenerate simplices,
    // for which it reports contact of polygons 0.1 m from each other (some 30 of a million configurations).
    const double size = scale_ * norm(world.bounds().hi - world.bounds().lo);
    const double slack = 0.5 * scale_ * slack_;
    const double obstacle_height = 0.2 * size;
    const double robot_height = 0.05 * size;
    for (const auto& part : world.parts()) {
      obstacles_.emplace_back(scaled_shape(part.shape, scale_), obstacle_height, slack);
      const Box2 box = bounding_box(part.shape);
      const Vec2 margin{slack_, slack_};
      boxes_.push_back({box.lo - margin, box.hi + margin});
    }
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
      auto object = std::make_unique<fcl::CollisionObjectd>(obstacles_[i].geometry, obstacles_[i].frame);
      object->setUserData(&boxes_[i]);
      objects_.push_back(std::move(object));
    }
    std::vector<fcl::CollisionObjectd*> registered;
    for (const auto& object : objects_) registered.push_back(object.get());
    if (!registered.empty()) {
      tree_.registerObjects(registered);
      tree_.setup();
    }
    found_.reserve(obstacles_.size());

    for (std::size_t i = 0; i < robot_.bodies().size(); ++i) {
      for (const auto& part : robot_.bodies()[i].parts) {
        pieces_.push_back({i, &part, Solid(scaled_shape(part, scale_), robot_height, slack), {}, {}});
      }
    }
    for (const auto& [first, second] : robot_.pairs()) {
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        for (std::size_t k = 0; k < pieces_.size(); ++k) {
          if (pieces_[i].body != first || pieces_[k].body != second) continue;
          // The body that stands for the obstacle has the height of obstacles.
          pairs_.push_back({i, k, Solid(scaled_shape(*pieces_[i].shape, scale_), obstacle_height, slack)});
        }
      }
    }
    frames_.resize(robot_.bodies().size());
    q_.resize(space_.dimension());
    // On a periodic axis a position wraps, so no box around the ends contains the whole motion.
    sweepable_ = robot_.members().empty() &&
                 (!robot_.translates() || (!space_.axes()[0].periodic && !space_.axes()[1].periodic));
    request_.num_max_contacts = 1;
    request_.enable_contact = false;
    // With the default of 1e-6, FCL misses contacts of shapes narrower than about 1e-6 m.
    request_.gjk_tolerance = 1e-14;
  }

  [[nodiscard]] double displacement(View a, View b) const override { return robot_.displacement_bound(space_, a, b); }

  Decision begin(View a, View b, std::uint32_t n) override {
    a_ = a;
    b_ = b;
    n_ = n;
    by_tree_ = true;
    if (!sweepable_) return Decision::undecided;
    const Vec2 from = robot_.translates() ? Vec2{a[0], a[1]} : robot_.base();
    const Vec2 to = robot_.translates() ? Vec2{b[0], b[1]} : robot_.base();
    const double radius = robot_.bounding_radius() + slack_;
    const Box2 swept{{std::min(from.x, to.x) - radius, std::min(from.y, to.y) - radius},
                     {std::max(from.x, to.x) + radius, std::max(from.y, to.y) + radius}};
    look_up(swept);
    if (found_.empty() && pairs_.empty() && margin_inside(swept, scene_->world.bounds()) >= 0.0) {
      return Decision::valid;
    }
    constexpr std::size_t few = 16;
    by_tree_ = found_.size() > few;
    return Decision::undecided;
  }

  Batch check(const Order& order, std::uint32_t rank) override {
    return one_by_one(rank, n_, [&](std::uint32_t at) {
      space_.interpolate(a_, b_, order.share(at), q_);
      return touches_at(q_, by_tree_);
    });
  }

  /// FCL has no segments.
  std::optional<double> end(std::uint32_t first) override {
    if (first < n_ || !robot_.is_point()) return std::nullopt;
    return exact().begin(a_, b_, n_) == Decision::valid ? std::nullopt : exact().end(n_);
  }

  /// FCL's distances have errors of about 1e-6 m, too large for a certificate.
  bool sweep(View a, View b, Certificate& certificate) override { return exact().sweep(a, b, certificate); }
  Distances on(View a, View b, double longest) override { return exact().on(a, b, longest); }

  [[nodiscard]] bool touches(View q) const override { return touches_at(q, true); }

  [[nodiscard]] double clearance(View q) const override {
    if (touches(q)) return 0.0;
    double best = std::numeric_limits<double>::infinity();
    fcl::DistanceRequestd request;
    for (Piece& piece : pieces_) {
      if (leaves(piece)) return 0.0;
      best = std::min(best, margin_inside(piece.box, scene_->world.bounds()));
      const Transform3 frame = frame_of(piece);
      for (std::size_t i = 0; i < obstacles_.size(); ++i) {
        if (box_distance(piece.box, boxes_[i]) >= best) continue;
        fcl::DistanceResultd result;
        const Solid& obstacle = obstacles_[i];
        fcl::distance(piece.solid.facing(obstacle), frame, obstacle.facing(piece.solid), obstacle.frame, request,
                      result);
        best = std::min(best, result.min_distance / scale_);
      }
    }
    for (const Pair& pair : pairs_) {
      const Solid& solid = pieces_[pair.second].solid;
      fcl::DistanceResultd result;
      fcl::distance(solid.facing(pair.solid), frame_of(pieces_[pair.second]), pair.solid.facing(solid), frame_of(pair),
                    request, result);
      best = std::min(best, result.min_distance / scale_);
    }
    return std::max(best, 0.0);
  }

  /// FCL's distances and nearest points have errors of about 1e-6 m.
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) const override { return exact().nearest_obstacle(q); }

  [[nodiscard]] std::optional<Contact> contact(View q) const override {
    robot_.place(q, frames_);
    for (std::size_t first = 0; first < pieces_.size();) {
      const std::size_t body = pieces_[first].body;
      std::optional<std::size_t> nearest;
      bool out = false;
      for (; first < pieces_.size() && pieces_[first].body == body; ++first) {
        Piece& piece = pieces_[first];
        out = leaves(piece) || out;
        const Transform3 frame = frame_of(piece);
        look_up(piece.box);
        for (const std::size_t i : found_) {
          if (!meet(piece.solid, frame, i)) continue;
          const std::size_t obstacle = scene_->world.parts()[i].obstacle;
          nearest = nearest ? std::min(*nearest, obstacle) : obstacle;
        }
      }
      if (nearest || out) return Contact{body, nearest};
    }
    for (const Pair& pair : pairs_) {
      if (meeting(pair)) return Contact{pieces_[pair.first].body, std::nullopt, pieces_[pair.second].body};
    }
    return std::nullopt;
  }

 private:
  struct Piece {
    std::size_t body;
    const ConvexShape* shape;
    Solid solid;
    ConvexShape moved;  ///< at the current pose, with its bounding box
    Box2 box;
  };

  /// Pieces of two bodies of a self-collision pair.
  struct Pair {
    std::size_t first;
    std::size_t second;
    Solid solid;  ///< of the first
  };

  /// The data that FCL passes to the callback of a tree query through one untyped pointer.
  struct Query {
    const FclPhase* phase;
    const Solid* solid = nullptr;  ///< nullptr: only collect the objects whose boxes overlap
    const Transform3* frame = nullptr;
    bool hit = false;
  };

  /// Returns Trellis' own narrow phase.
  [[nodiscard]] NarrowPhase& exact() const {
    if (!exact_) exact_ = make_planar_phase(scene_, space_);
    return *exact_;
  }

  /// Whether the robot touches something at q.
  /// \param by_tree  whether to ask the tree; else the obstacles of `found_` are all that may be near
  [[nodiscard]] bool touches_at(View q, bool by_tree) const {
    robot_.place(q, frames_);
    return std::any_of(pieces_.begin(), pieces_.end(),
                       [&](Piece& piece) { return by_tree ? invalid_by_tree(piece) : invalid_by_found(piece); }) ||
           std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) { return meeting(pair); });
  }

  static bool on_pair(fcl::CollisionObjectd* first, fcl::CollisionObjectd* second, void* data) {
    auto& query = *static_cast<Query*>(data);
    const FclPhase& phase = *query.phase;
    const auto* object = first == &phase.probe_ ? second : first;
    const auto i = static_cast<std::size_t>(static_cast<const Box2*>(object->getUserData()) - phase.boxes_.data());
    if (query.solid == nullptr) {
      phase.found_.push_back(i);
      return false;
    }
    query.hit = phase.meet(*query.solid, *query.frame, i);
    return query.hit;
  }

  void ask_tree(const Box2& box, Query& query) const {
    if (objects_.empty()) return;
    // The tree takes objects, not boxes: use a flat box in the plane that all solids intersect.
    const Vec2 lo = scale_ * box.lo;
    const Vec2 hi = scale_ * box.hi;
    probe_box_->side = Vector3(hi.x - lo.x, hi.y - lo.y, 0.0);
    probe_box_->computeLocalAABB();
    probe_.setTranslation(Vector3(0.5 * (lo.x + hi.x), 0.5 * (lo.y + hi.y), 0.0));
    probe_.computeAABB();
    tree_.collide(&probe_, &query, &on_pair);
  }

  void look_up(const Box2& box) const {
    found_.clear();
    Query query{this};
    ask_tree(box, query);
  }

  /// Whether the solid collides with an obstacle's part.
  [[nodiscard]] bool meet(const Solid& solid, const Transform3& frame, std::size_t i) const {
    const Solid& obstacle = obstacles_[i];
    result_.clear();
    return fcl::collide(solid.facing(obstacle), frame, obstacle.facing(solid), obstacle.frame, request_, result_) > 0;
  }

  [[nodiscard]] Pose2 scaled(const Pose2& pose) const { return {scale_ * pose.x, scale_ * pose.y, pose.c, pose.s}; }

  [[nodiscard]] Transform3 frame_of(const Piece& piece) const {
    const Transform3 frame = transform(scaled(frames_[piece.body]));
    return piece.solid.framed ? frame * piece.solid.frame : frame;
  }

  [[nodiscard]] Transform3 frame_of(const Pair& pair) const {
    const Transform3 frame = transform(scaled(frames_[pieces_[pair.first].body]));
    return pair.solid.framed ? frame * pair.solid.frame : frame;
  }

  /// Whether the pieces, at their current poses, collide.
  [[nodiscard]] bool meeting(const Pair& pair) const {
    const Piece& second = pieces_[pair.second];
    const Vec2 margin{slack_, slack_};
    const Box2& box = pieces_[pair.first].box;
    if (!overlap({box.lo - margin, box.hi + margin}, second.box)) return false;
    result_.clear();
    return fcl::collide(second.solid.facing(pair.solid), frame_of(second), pair.solid.facing(second.solid),
                        frame_of(pair), request_, result_) > 0;
  }

  /// Moves the piece to its body's frame. \return whether it leaves the world there
  bool leaves(Piece& piece) const {
    move_shape(*piece.shape, frames_[piece.body], piece.moved);
    piece.box = bounding_box(piece.moved);
    return !(margin_inside(piece.box, scene_->world.bounds()) >= -slack_);
  }

  bool invalid_by_tree(Piece& piece) const {
    if (leaves(piece)) return true;
    const Transform3 frame = frame_of(piece);
    Query query{this, &piece.solid, &frame};
    ask_tree(piece.box, query);
    return query.hit;
  }

  bool invalid_by_found(Piece& piece) const {
    if (leaves(piece)) return true;
    std::optional<Transform3> frame;
    for (const std::size_t i : found_) {
      if (!overlap(piece.box, boxes_[i])) continue;
      if (!frame) frame = frame_of(piece);
      if (meet(piece.solid, *frame, i)) return true;
    }
    return false;
  }

  std::shared_ptr<const PlanarScene> scene_;
  const Robot& robot_;
  Space space_;
  double slack_ = 0.0;
  double scale_ = 1.0;  ///< of what FCL receives
  bool sweepable_ = false;
  std::vector<Solid> obstacles_;  ///< the world's parts, with boxes and objects
  std::vector<Box2> boxes_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  std::vector<Pair> pairs_;
  fcl::CollisionRequestd request_;

  mutable std::unique_ptr<NarrowPhase> exact_;  ///< made at the first call of `exact`

  // The motion that has begun.
  View a_;
  View b_;
  std::uint32_t n_ = 0;
  bool by_tree_ = true;  ///< more obstacles are near it than `found_` serves for

  // Scratch.
  mutable fcl::DynamicAABBTreeCollisionManagerd tree_;
  mutable std::vector<Piece> pieces_;  ///< the robot's, body by body
  mutable std::shared_ptr<fcl::Boxd> probe_box_ = std::make_shared<fcl::Boxd>(1.0, 1.0, 1.0);
  mutable fcl::CollisionObjectd probe_{probe_box_};
  mutable fcl::CollisionResultd result_;
  mutable std::vector<std::size_t> found_;
  mutable std::vector<Pose2> frames_;
  mutable Configuration q_;
};

}  // namespace

std::unique_ptr<Checker> make_fcl_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution) {
  auto planar = planar_scene(std::move(scene));
  check_fits(*planar, space, resolution);
  return std::make_unique<Checker>(*planar, std::make_unique<FclPhase>(planar, space), resolution);
}

}  // namespace trellis
