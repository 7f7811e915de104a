// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/collision/common.hpp>
#include <trellis/collision/spatial/body_phase.hpp>
#include <trellis/collision/spatial/near_filter.hpp>
#include <trellis/collision/spatial/segment.hpp>
#include <trellis/collision/spatial/separation.hpp>
#include <trellis/collision/spatial/shared_cache.hpp>
#include <trellis/collision/spatial/surface_pair.hpp>
#include <trellis/scene/cache_by_world.hpp>
#include <trellis/scene/spatial/box_tree.hpp>
#include <trellis/scene/spatial/obstacle_distance.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/ranges.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/spatial/surface.hpp>

namespace trellis {

namespace {

using Vector3 = fcl::Vector3d;
using Transform3 = fcl::Transform3d;
using Geometry = std::shared_ptr<const fcl::CollisionGeometryd>;
using Tree = fcl::BVHModel<fcl::OBBRSSd>;

Vector3 vector(const Vec3& p) { return {p.x, p.y, p.z}; }

/// Returns what lengths are multiplied by for FCL, a power of two: 1 but where the robot or the world is so small that
/// the tolerances of FCL's iterations, which are lengths, are of its size. No world becomes larger than 2^21 m by it.
double scale_for_fcl(const World3& world, const Robot3& robot) {
  const double diagonal = norm(world.bounds().hi - world.bounds().lo);
  const double radius = robot.bounding_radius();
  const double size = radius > 0.0 ? std::min(diagonal, 16.0 * radius) : diagonal;
  constexpr double small = 0x1p-8;
  if (!(size > 0.0 && size < small)) return 1.0;
  constexpr int most = 512;
  const int exponent = std::min({4 - std::ilogb(size), 20 - std::ilogb(diagonal), most});
  return std::ldexp(1.0, std::max(exponent, 0));
}

Transform3 transform(const Pose3& pose, double scale) {
  const Quaternion& q = pose.orientation;
  Transform3 result = Transform3::Identity();
  result.linear() = fcl::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  result.translation() = vector(scale * pose.position);
  return result;
}

/// A mesh as checkers use it.
struct MeshModel {
  MeshModel(const std::shared_ptr<const Mesh>& mesh, double scale)
      : tree(std::make_shared<Tree>()), distance(mesh), components(components_of(*mesh)) {
    std::vector<Vector3> vertices;
    vertices.reserve(mesh->vertices().size());
    for (const Vec3& v : mesh->vertices()) vertices.push_back(vector(scale * v));
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(mesh->triangles().size());
    for (const auto& [a, b, c] : mesh->triangles()) triangles.emplace_back(a, b, c);
    tree->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
    tree->addSubModel(vertices, triangles);
    tree->endModel();
    tree->computeLocalAABB();
  }

  std::shared_ptr<Tree> tree;  ///< scaled
  MeshDistance distance;
  std::vector<MeshComponent> components;
};

/// Returns the model of a mesh, which all checkers of all threads share.
std::shared_ptr<const MeshModel> model_of(const std::shared_ptr<const Mesh>& mesh, double scale) {
  static SharedCache<std::pair<std::uint64_t, double>, MeshModel> cache;
  constexpr std::size_t small = 20'000;
  return cache.get({mesh->hash(), scale}, mesh->triangles().size() <= small, [&] { return MeshModel(mesh, scale); });
}

/// Makes the models of the meshes of a world and a robot, which live as long as the world.
void keep_models(const World3& world, const Robot3& robot, double scale) {
  using Models = std::vector<std::shared_ptr<const MeshModel>>;
  using Key = std::pair<double, std::vector<std::uint64_t>>;
  static CacheByWorld<Models, Key> cache;
  const auto mesh_of = [](const Solid& solid) { return std::get_if<std::shared_ptr<const Mesh>>(&solid.shape); };
  Key key{scale, {}};
  for (const Solid& solid : robot.solids()) {
    if (const auto* mesh = mesh_of(solid)) key.second.push_back((*mesh)->hash());
  }
  static_cast<void>(cache.get(world, key, [&](const World3& of) {
    Models models;
    for (const Obstacle3& obstacle : of.obstacles()) {
      if (const auto* mesh = mesh_of(obstacle.solid)) models.push_back(model_of(*mesh, scale));
    }
    for (const Solid& solid : robot.solids()) {
      if (const auto* mesh = mesh_of(solid)) models.push_back(model_of(*mesh, scale));
    }
    return models;
  }));
}

/// Returns a shape that contains all points within `by` metres of a shape that is no mesh.
struct Inflate {
  double by;

  Shape3 operator()(const Sphere& sphere) const { return Sphere{sphere.radius + by}; }
  Shape3 operator()(const Cuboid& cuboid) const { return Cuboid{cuboid.size + Vec3{2.0 * by, 2.0 * by, 2.0 * by}}; }
  Shape3 operator()(const Cylinder& c) const { return Cylinder{c.radius + by, c.length + 2.0 * by}; }
  Shape3 operator()(const Capsule& c) const { return Capsule{c.radius + by, c.length}; }
  Shape3 operator()(const std::shared_ptr<const Mesh>& mesh) const { return mesh; }
  Shape3 operator()(const std::shared_ptr<const PointCloud>&) const { throw Fault("a cloud that is inflated"); }
};

struct MakeGeometry {
  Geometry operator()(const Sphere& sphere) const { return std::make_shared<fcl::Sphered>(sphere.radius); }
  Geometry operator()(const Cuboid& cuboid) const { return std::make_shared<fcl::Boxd>(vector(cuboid.size)); }
  Geometry operator()(const Cylinder& c) const { return std::make_shared<fcl::Cylinderd>(c.radius, c.length); }
  Geometry operator()(const Capsule& c) const { return std::make_shared<fcl::Capsuled>(c.radius, c.length); }
  Geometry operator()(const std::shared_ptr<const Mesh>&) const { return nullptr; }
  Geometry operator()(const std::shared_ptr<const PointCloud>&) const { return nullptr; }
};

std::shared_ptr<const MeshDistance> surface_of(const Cuboid& cuboid) {
  const Vec3 half = 0.5 * cuboid.size;
  std::vector<Vec3> vertices;
  for (const double x : {-half.x, half.x}) {
    for (const double y : {-half.y, half.y}) {
      for (const double z : {-half.z, half.z}) vertices.push_back({x, y, z});
    }
  }
  std::vector<Triangle> triangles{{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                                  {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return std::make_shared<const MeshDistance>(
      std::make_shared<const Mesh>(std::move(vertices), std::move(triangles), "box"));
}

/// A solid as FCL has it.
struct Piece {
  Piece(const Solid& s, double scale) : solid(s) {
    if (const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&s.shape)) {
      model = model_of(*mesh, scale);
      geometry = model->tree;
      surface = {model, &model->distance};
    } else if (const auto* points = std::get_if<std::shared_ptr<const PointCloud>>(&s.shape)) {
      cloud = points->get();
    } else {
      geometry = std::visit(MakeGeometry(), scaled({s.shape, {}}, scale).shape);
    }
    const Box3 box = bounding_box({s.shape, {}});
    middle = 0.5 * (box.lo + box.hi);
    half = 0.5 * (box.hi - box.lo);
  }

  /// Gives a box triangles, so that it can be compared with meshes.
  void add_surface() {
    const auto* cuboid = std::get_if<Cuboid>(&solid.shape);
    if (cuboid == nullptr) return;
    const Vec3& size = cuboid->size;
    // A mesh has no triangles whose area is 0, which rounding makes of sides of 1e-200 m.
    const double least = std::min({size.x, size.y, size.z});
    if (0.25 * least * least > 0.0) surface = surface_of(*cuboid);
  }

  /// Grows the geometry that `collide` sees by so many metres, so that solids that touch are in collision: for some
  /// pairs, as a cylinder that lies on a box, FCL says that they are not.
  void touch_within(double slack, double scale) {
    const auto* sphere = std::get_if<Sphere>(&solid.shape);
    if (model != nullptr || cloud != nullptr || (sphere != nullptr && sphere->radius == 0.0)) return;
    touching = std::visit(MakeGeometry(), scaled({std::visit(Inflate{slack}, solid.shape), {}}, scale).shape);
  }
  [[nodiscard]] const Geometry& collided() const { return touching ? touching : geometry; }

  /// Whether the piece is a closed mesh.
  [[nodiscard]] bool has_inside() const { return model != nullptr && model->distance.mesh().closed(); }

  Solid solid;
  Geometry geometry;                            ///< scaled; none of a cloud
  Geometry touching;                            ///< the same, a little larger; none where `geometry` serves
  const PointCloud* cloud = nullptr;            ///< where it is one
  std::shared_ptr<const MeshModel> model;       ///< where it is a mesh
  std::shared_ptr<const MeshDistance> surface;  ///< its triangles: of a mesh, and of a box among meshes
  Vec3 middle, half;                            ///< of its bounding box in its own frame
};

/// Returns a box that contains the piece at a pose: the smallest one of its bounding box.
Box3 box_at(const Piece& piece, const Turn& turn) {
  const Vec3 x = piece.half.x * turn.x, y = piece.half.y * turn.y, z = piece.half.z * turn.z;
  const Vec3 half{std::abs(x.x) + std::abs(y.x) + std::abs(z.x), std::abs(x.y) + std::abs(y.y) + std::abs(z.y),
                  std::abs(x.z) + std::abs(y.z) + std::abs(z.z)};
  const Vec3 middle = turn(piece.middle);
  return {middle - half, middle + half};
}

/// Returns the smallest box along the axes that contains the piece.
Box3 exact_box(const Piece& piece, const Pose3& pose) {
  if (piece.model == nullptr) return bounding_box(Solid{piece.solid.shape, pose});
  const Turn turn(pose);
  const auto& vertices = piece.model->distance.mesh().vertices();
  const Vec3 first = turn(vertices.front());
  Box3 box{first, first};
  for (const Vec3& vertex : vertices) {
    const Vec3 p = turn(vertex);
    box = {least_of(box.lo, p), greatest_of(box.hi, p)};
  }
  return box;
}

/// Whether a part of `inner` lies inside the closed mesh `outer`, where no triangle of it meets the inner piece: each
/// component of a surface then lies wholly inside or outside. Poses refer to the same frame.
bool lies_inside(const Piece& inner, const Pose3& inner_pose, const Piece& outer, const Pose3& outer_pose) {
  const MeshDistance& mesh = outer.model->distance;
  const Pose3 into = outer_pose.inverse() * inner_pose;
  if (inner.model == nullptr) return mesh.contains(into.position);
  const auto& components = inner.model->components;
  return std::any_of(components.begin(), components.end(),
                     [&](const MeshComponent& component) { return mesh.contains(into(component.vertex)); });
}

/// Whether a part of the mesh `inner` lies inside the box `outer`, where their surfaces are apart.
bool holds_part(const Piece& outer, const Pose3& outer_pose, const Piece& inner, const Pose3& inner_pose) {
  if (outer.model != nullptr || inner.model == nullptr) return false;
  const Pose3 into = outer_pose.inverse() * inner_pose;
  const auto& components = inner.model->components;
  return std::any_of(components.begin(), components.end(), [&](const MeshComponent& component) {
    const Vec3 p = into(component.vertex);
    return std::abs(p.x) < outer.half.x && std::abs(p.y) < outer.half.y && std::abs(p.z) < outer.half.z;
  });
}

bool overlap(const Box3& a, const Box3& b) {
  return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z &&
         b.lo.z <= a.hi.z;
}

/// Returns the distance between two boxes, 0 where they overlap.
double gap_between(const Box3& a, const Box3& b) {
  const auto gap = [](double a_lo, double a_hi, double b_lo, double b_hi) {
    return std::max({0.0, a_lo - b_hi, b_lo - a_hi});
  };
  return norm(
      {gap(a.lo.x, a.hi.x, b.lo.x, b.hi.x), gap(a.lo.y, a.hi.y, b.lo.y, b.hi.y), gap(a.lo.z, a.hi.z, b.lo.z, b.hi.z)});
}

/// Returns the signed distance of a piece's surface from the nearest point of a cloud less the radius of its balls:
/// `at_most` where it is not less, and at most 0 where a ball is in contact.
/// \param into    from the cloud's frame to that of the piece
/// \param inside  whether what lies inside a closed mesh is in contact
double distance_from_cloud(const Piece& piece, const Pose3& into, const PointCloud& cloud, bool inside,
                           double at_most) {
  // The piece's bounding box, in the cloud's frame.
  const double reach = at_most + cloud.radius();
  if (!(reach > 0.0)) return at_most;
  const Turn back(into.inverse());
  const Box3 tight = box_at(piece, back);
  const Turn turn(into);
  const Box3 own{piece.middle - piece.half, piece.middle + piece.half};
  double best = reach;
  const auto compare = [&](std::size_t i) {
    const Vec3 p = turn(cloud.points()[i]);
    if (gap_between({p, p}, own) >= best) return true;
    double distance = 0.0;
    if (piece.model == nullptr) {
      distance = distance_to({piece.solid.shape, {}}, p);
    } else if (!inside || !piece.has_inside() || !piece.model->distance.contains(p)) {
      distance = piece.model->distance.to_surface(p, best);
    }
    best = std::min(best, distance);
    return best > 0.0;
  };
  // A near point leaves few others to compare.
  if (reach > norm(piece.half)) static_cast<void>(compare(cloud.nearest(back(piece.middle)).index));
  const Vec3 margin{best, best, best};
  cloud.each_near({tight.lo - margin, tight.hi + margin}, compare);
  return best < reach ? best - cloud.radius() : at_most;
}

/// Returns the least distance from a box to the sides of one that contains it; negative where it does not.
double margin_inside(const Box3& box, const Box3& bounds) {
  const Vec3 low = box.lo - bounds.lo, high = bounds.hi - box.hi;
  return std::min({low.x, low.y, low.z, high.x, high.y, high.z});
}

/// FCL, after sphere covers and a distance field where they decide.
class FclBodyPhase final : public BodyPhase {
 public:
  FclBodyPhase(std::shared_ptr<const Scene> scene, Space space, bool filtered)
      : scene_(std::move(scene)),
        world_(spatial(*scene_).world),
        robot_(spatial(*scene_).robot),
        space_(std::move(space)) {
    slack_ = touching_slack(*scene_);
    scale_ = scale_for_fcl(world_, robot_);
    keep_models(world_, robot_, scale_);
    const Vec3 margin{slack_, slack_, slack_};
    obstacles_.reserve(world_.obstacles().size());
    for (const Obstacle3& obstacle : world_.obstacles()) {
      obstacles_.emplace_back(obstacle.solid, scale_);
      frames_.push_back(transform(obstacle.solid.pose, scale_));
      inverses_.push_back(obstacle.solid.pose.inverse());
      const Box3 box = bounding_box(obstacle.solid);
      boxes_.push_back({box.lo - margin, box.hi + margin});
    }
    tree_ = BoxTree(boxes_);
    for (const Solid& solid : robot_.solids()) {
      pieces_.emplace_back(solid, scale_);
      pieces_.back().touch_within(slack_, scale_);
    }
    const auto is_mesh = [](const Piece& piece) { return piece.model != nullptr; };
    const bool mesh_among_obstacles = std::any_of(obstacles_.begin(), obstacles_.end(), is_mesh);
    const bool mesh_in_robot = std::any_of(pieces_.begin(), pieces_.end(), is_mesh);
    for (Piece& piece : pieces_) {
      if (mesh_among_obstacles) piece.add_surface();
    }
    for (Piece& obstacle : obstacles_) {
      if (mesh_in_robot) obstacle.add_surface();
    }
    if (filtered && NearFilter::pays(spatial(*scene_))) filter_.emplace(spatial(*scene_), slack_);
    q_.resize(space_.dimension());
    request_.num_max_contacts = 1;
    request_.enable_contact = false;
    request_.gjk_tolerance = 1e-14;
  }

  [[nodiscard]] double displacement(View a, View b) const override { return robot_.displacement_bound(a, b); }

  Decision begin(View a, View b, std::uint32_t n) override {
    a_ = a;
    b_ = b;
    n_ = n;
    if (filter_) {
      displacement_ = robot_.displacement_bound(a, b);
      free_.assign(n + std::size_t{1}, 0);
    }
    return Decision::undecided;
  }

  Batch check(const Order& order, std::uint32_t rank) override {
    if (!filter_) {
      return one_by_one(rank, n_, [&](std::uint32_t at) {
        space_.interpolate(a_, b_, order.share(at), q_);
        return !valid_at(robot_.pose(q_));
      });
    }
    // Rounding, in the displacement and in interpolation, is far below the filter's margin.
    const double per_configuration = displacement_ / n_;
    return one_by_one(rank, n_, [&](std::uint32_t at) {
      const std::uint32_t index = order.indices[at];
      if (free_[index] != 0) return false;
      space_.interpolate(a_, b_, order.share(at), q_);
      // Both margins shrink by at most the displacement.
      const double sure = sure_clearance(robot_.pose(q_), displacement_ * gap_before(at));
      if (sure < 0.0) return true;
      mark_free(free_.data(), n_, index, sure, per_configuration);
      return false;
    });
  }

  std::optional<double> end(std::uint32_t first) override {
    return first == n_ ? contact_between(a_, b_) : std::nullopt;
  }

  bool sweep(View a, View b, Certificate& certificate) override {
    const auto at = contact_between(a, b);
    if (at) certificate.refuted_at = at;
    return at.has_value();
  }

  Distances on(View a, View b, double longest) override {
    clearances_.emplace(*this, a, b);
    // The segment of a point decides; distances only give the clearance.
    return {*clearances_,
            clearances_->displacement(),
            longest,
            {},
            robot_.is_point() ? std::optional(slack_) : std::nullopt};
  }

  [[nodiscard]] bool touches(View q) const override { return !valid_at(robot_.pose(q)); }
  [[nodiscard]] bool valid_at(const Pose3& pose) const override {
    return boundary_margin(pose, 0.0) >= -slack_ && free_of_obstacles(pose, Turn(pose), 0.0) >= 0.0;
  }
  [[nodiscard]] double sure_clearance(const Pose3& pose, double enough) const override {
    const double margin = boundary_margin(pose, enough);
    const double clearance = margin >= -slack_ ? free_of_obstacles(pose, Turn(pose), enough) : -1.0;
    return clearance < 0.0 ? -1.0 : std::max(std::min(clearance, margin), 0.0);
  }

  [[nodiscard]] double clearance(View q) const override {
    const Pose3 pose = robot_.pose(q);
    return valid_at(pose) ? clearance_at(pose) : 0.0;
  }
  [[nodiscard]] double clearance_at(const Pose3& pose) const override {
    double best = std::numeric_limits<double>::infinity();
    if (world_.contain() == Contain::reference) {
      best = margin_inside({pose.position, pose.position}, world_.bounds());
    }
    if (world_.contain() == Contain::robot) {
      for (const Piece& piece : pieces_) {
        const Solid placed{piece.solid.shape, pose * piece.solid.pose};
        best = std::min(best, margin_inside(bounding_box(placed), world_.bounds()));
      }
    }
    return std::max(obstacle_distance(pose, best), 0.0);
  }

  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) const override {
    if (obstacles_.empty()) return std::nullopt;
    const Pose3 pose = robot_.pose(q);
    if (const auto met = met_obstacle(pose)) return Proximity{*met, 0.0};
    Proximity nearest{0, std::numeric_limits<double>::infinity()};
    for (const Piece& piece : pieces_) {
      const Pose3 at = pose * piece.solid.pose;
      const Box3 box = box_at(piece, Turn(at));
      for (std::size_t i = 0; i < obstacles_.size(); ++i) {
        if (gap_between(box, boxes_[i]) > nearest.distance) continue;
        const Proximity found = proximity(piece, at, i);
        const bool before =
            found.distance < nearest.distance || (found.distance == nearest.distance && i < nearest.obstacle);
        if (before) nearest = found;
      }
    }
    return nearest;
  }

  [[nodiscard]] std::optional<Contact> contact(View q) const override {
    const Pose3 pose = robot_.pose(q);
    if (valid_at(pose)) return std::nullopt;
    return Contact{0, met_obstacle(pose)};
  }

  [[nodiscard]] std::optional<std::size_t> met_obstacle(const Pose3& pose) const override {
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
      for (const Piece& piece : pieces_) {
        const Pose3 at = pose * piece.solid.pose;
        if (overlap(box_at(piece, Turn(at)), boxes_[i]) && meet(piece, at, transform(at, scale_), i)) return i;
      }
    }
    return std::nullopt;
  }

  /// What FCL's distances cannot certify, since their iterations end early, is decided by contact with inflated shapes
  /// and by distances of triangles.
  [[nodiscard]] bool apart_throughout(const SeenMotion& motion, double half, double margin) const override {
    const double by = half * motion.displacement + margin;
    return (boundary_margin(motion.pose, by) >= by && certainly_apart(motion.pose, by)) ||
           separated(motion, half, margin + 2.0 * slack_).throughout > margin + slack_;
  }

  [[nodiscard]] MotionClearance::Near near_throughout(const SeenMotion& motion, double half,
                                                      double at_most) const override {
    const double displacement = half * motion.displacement;
    const double cut = at_most + displacement;
    const Pose3& pose = motion.pose;
    const double margin = boundary_margin(pose, cut);
    if (margin <= slack_ || free_of_obstacles(pose, Turn(pose), 0.0) < 0.0) return {0.0, -displacement};
    const double limit = std::min(cut, margin);
    if (robot_.is_point()) {
      const double found = distance_of_point(pose.position, limit);
      return {std::min(found, at_most), std::min(found - displacement, at_most)};
    }
    // What FCL's iterations may leave out.
    constexpr double relative = 1e-4;
    const double absolute = 1e-5 / scale_;
    const double reach = limit * (1.0 + 2.0 * relative) + 2.0 * absolute;
    double found = obstacle_distance(pose, reach);
    if (found >= reach) return {std::min(limit, at_most), std::min(limit - displacement, at_most)};
    const double certain = std::min(found * (1.0 - relative) - absolute, margin);
    bool inexact = certain < certified_share * std::min(found, margin);
    double sure = certain - displacement;
    if (inexact) {
      const SeparationGap gap = separated(motion, half, reach);
      if (gap.middle > slack_) {
        // A bound may be far less than the distance: then FCL's, and inflated shapes, say more.
        const double least = std::min(found, margin);
        if (gap.middle > 0.5 * least) found = std::min(found, gap.middle);
        inexact = gap.middle < certified_share * std::min(found, margin);
        sure = std::max(sure, gap.throughout - slack_);
      }
    }
    // Close to contact inflated shapes show more than such a distance does.
    for (const double share : {0.5, 0.1, 0.0}) {
      const double inflated = share * std::max(std::min(found, margin) - displacement, 0.0);
      if (sure > inflated || displacement >= margin) break;
      if (!certainly_apart(pose, displacement + inflated)) continue;
      sure = std::max(inflated, slack_);
      break;
    }
    return {std::min(std::max(found, slack_), at_most), std::min(sure, at_most), inexact};
  }

 private:
  /// Returns a margin inside the boundary that the robot has, the exact one where that is less than `enough`; negative
  /// where it leaves the boundary.
  [[nodiscard]] double boundary_margin(const Pose3& pose, double enough) const {
    if (world_.contain() == Contain::none) return std::numeric_limits<double>::infinity();
    const Vec3& p = pose.position;
    const double of_reference = margin_inside({p, p}, world_.bounds());
    if (world_.contain() == Contain::reference) return of_reference;
    if (const double of_ball = of_reference - robot_.bounding_radius(); of_ball >= enough) return of_ball;
    double margin = std::numeric_limits<double>::infinity();
    for (const Piece& piece : pieces_) {
      const Pose3 at = pose * piece.solid.pose;
      double of_piece = margin_inside(box_at(piece, Turn(at)), world_.bounds());
      if (!(of_piece >= enough)) of_piece = margin_inside(exact_box(piece, at), world_.bounds());
      margin = std::min(margin, of_piece);
      if (!(margin >= -slack_)) return margin;
    }
    return margin;
  }

  /// Returns the distance of a point from a piece, of a mesh from its surface, in metres.
  /// \param into  the inverse of the piece's pose
  [[nodiscard]] static double distance_from(const Piece& piece, const Pose3& into, const Vec3& p) {
    return piece.model != nullptr ? piece.model->distance.to_surface(into(p))
                                  : distance_to({piece.solid.shape, {}}, into(p));
  }

  /// Returns the distance of a cloud from a piece of the robot, at most 0 in contact; `at_most` where it is not less.
  [[nodiscard]] double cloud_distance(const Piece& piece, const Pose3& at, std::size_t i, double at_most) const {
    const Pose3 into = at.inverse() * obstacles_[i].solid.pose;
    return distance_from_cloud(piece, into, *obstacles_[i].cloud, !world_.surface(), at_most);
  }

  /// Returns the distance of an obstacle from a piece of the robot that does not meet it. A nearest point of FCL, whose
  /// iterations end early, counts only if it lies on the obstacle and has that distance.
  [[nodiscard]] Proximity proximity(const Piece& piece, const Pose3& at, std::size_t i) const {
    if (robot_.is_point() && obstacles_[i].model != nullptr) {
      const Vec3 p = at.position;
      const Vec3 point = obstacles_[i].solid.pose(obstacles_[i].model->distance.nearest(inverses_[i](p)));
      return {i, norm(p - point), point};
    }
    if (const PointCloud* cloud = obstacles_[i].cloud; cloud != nullptr) {
      Proximity found{i, std::max(cloud_distance(piece, at, i, std::numeric_limits<double>::infinity()), 0.0)};
      if (robot_.is_point() && found.distance > 0.0) {
        // The nearest point of the ball.
        const Vec3 p = inverses_[i](at.position);
        const Vec3 centre = cloud->points()[cloud->nearest(p).index];
        found.point = obstacles_[i].solid.pose(centre + (cloud->radius() / norm(p - centre)) * (p - centre));
      }
      return found;
    }
    fcl::DistanceRequestd request;
    request.enable_nearest_points = true;
    fcl::DistanceResultd result;
    fcl::distance(piece.geometry.get(), transform(at, scale_), obstacles_[i].geometry.get(), frames_[i], request,
                  result);
    Proximity found{i, std::max(result.min_distance / scale_, 0.0)};
    const Vector3& q = result.nearest_points[1];
    const Vec3 point{q.x() / scale_, q.y() / scale_, q.z() / scale_};
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) return found;
    const double tolerance = 1e-4 * found.distance + 1e-5 / scale_;
    if (distance_from(obstacles_[i], inverses_[i], point) > tolerance) return found;
    if (std::abs(distance_from(piece, at.inverse(), point) - found.distance) <= tolerance) found.point = point;
    return found;
  }

  /// The distances of the robot on a motion.
  class Clearances final : public MotionClearance {
   public:
    Clearances(const FclBodyPhase& phase, View a, View b) : phase_(phase), a_(a), b_(b) {
      motion_.displacement = phase.robot_.displacement_bound(a, b);
      motion_.whole = body_motion(phase.robot_.pose(a), phase.robot_.pose(b));
    }

    /// Of the whole motion, in metres.
    [[nodiscard]] double displacement() const { return motion_.displacement; }

    [[nodiscard]] unsigned apart(std::span<const double> shares, double half, double margin) override {
      unsigned found = 0;
      for (std::size_t i = 0; i < shares.size(); ++i) {
        if (phase_.apart_throughout(seen_at(shares[i]), half, margin)) found |= 1U << i;
      }
      return found;
    }
    [[nodiscard]] Near near(double share, double half, double at_most) override {
      return phase_.near_throughout(seen_at(share), half, at_most);
    }

   private:
    const SeenMotion& seen_at(double share) {
      phase_.space_.interpolate(a_, b_, share, phase_.q_);
      motion_.pose = phase_.robot_.pose(phase_.q_);
      return motion_;
    }

    const FclBodyPhase& phase_;
    View a_;
    View b_;
    SeenMotion motion_;
  };

  /// Whether all obstacles are certainly farther than `by` metres from the robot. Decides nothing about a body inside
  /// a mesh: on a motion that begins outside, all surfaces stay apart.
  [[nodiscard]] bool certainly_apart(const Pose3& pose, double by) const {
    if (filter_) {
      const NearFilter::Answer answer = filter_->decide(Turn(pose), by);
      if (answer.verdict == NearFilter::Verdict::meets) return false;
      if (answer.verdict == NearFilter::Verdict::free && answer.clearance > by) return true;
    }
    const Vec3 margin{by, by, by};
    return std::all_of(pieces_.begin(), pieces_.end(), [&](const Piece& piece) {
      const Pose3 at = pose * piece.solid.pose;
      const Box3 tight = box_at(piece, Turn(at));
      const Box3 box{tight.lo - margin, tight.hi + margin};
      bool all = true;
      tree_.each([&](const Box3& other) { return all && overlap(box, other); },
                 [&](std::uint32_t i) { all = all && (!overlap(box, boxes_[i]) || pair_apart(piece, at, i, by)); });
      return all;
    });
  }

  /// Returns what directions of separation show about the interval with this middle: the least gap from the boundary
  /// and the obstacles. Gaps of at least `enough` count as that.
  [[nodiscard]] SeparationGap separated(const SeenMotion& seen, double half, double enough) const {
    const Pose3& pose = seen.pose;
    const double by = enough + half * seen.displacement;
    const BodyMotion motion = seen.part(half);
    SeparationGap all{by, enough};
    const auto add = [&](const SeparationGap& gap) {
      all.middle = std::min(all.middle, gap.middle);
      all.throughout = std::min(all.throughout, gap.throughout - half * seen.rest);
    };
    const Box3& bounds = world_.bounds();
    const Contain contain = world_.contain();
    if (contain == Contain::reference) add(gap_inside({Sphere{0.0}, {pose.position, {}}}, motion, bounds));
    const Vec3 margin{by, by, by};
    for (const Piece& piece : pieces_) {
      const Pose3 at = pose * piece.solid.pose;
      const Box3 tight = box_at(piece, Turn(at));
      const Box3 box{tight.lo - margin, tight.hi + margin};
      if (contain == Contain::robot && margin_inside(box, bounds) < 0.0) {
        add(gap_inside({piece.solid.shape, at}, motion, bounds));
      }
      tree_.each([&](const Box3& other) { return all.throughout > 0.0 && overlap(box, other); },
                 [&](std::uint32_t i) {
                   if (all.throughout <= 0.0 || !overlap(box, boxes_[i])) return;
                   if (obstacles_[i].cloud != nullptr) {
                     add(cloud_gap({piece.solid.shape, at}, motion, i, box));
                     return;
                   }
                   add(separation_gap({piece.solid.shape, at}, motion, obstacles_[i].solid));
                 });
      if (all.throughout <= 0.0) break;
    }
    return all;
  }

  /// Returns the least gap from the balls of a cloud that may meet a box.
  [[nodiscard]] SeparationGap cloud_gap(const Solid& moving, const BodyMotion& motion, std::size_t i,
                                        const Box3& box) const {
    constexpr int most_balls = 500;
    const PointCloud& cloud = *obstacles_[i].cloud;
    const Pose3& pose = obstacles_[i].solid.pose;
    const Box3 seen = bounding_box({Cuboid{box.hi - box.lo}, inverses_[i] * Pose3{0.5 * (box.lo + box.hi), {}}});
    const Vec3 margin{cloud.radius(), cloud.radius(), cloud.radius()};
    constexpr double infinity = std::numeric_limits<double>::infinity();
    SeparationGap all{infinity, infinity};
    int balls = 0;
    cloud.each_near({seen.lo - margin, seen.hi + margin}, [&](std::size_t k) {
      const Solid ball{Sphere{cloud.radius()}, {pose(cloud.points()[k]), {}}};
      if (gap_between(bounding_box(ball), box) > 0.0) return true;
      const SeparationGap gap = ++balls > most_balls ? SeparationGap{} : separation_gap(moving, motion, ball);
      all.middle = std::min(all.middle, gap.middle);
      all.throughout = std::min(all.throughout, gap.throughout);
      return all.throughout > 0.0;
    });
    return all;
  }

  [[nodiscard]] bool pair_apart(const Piece& piece, const Pose3& pose, std::size_t i, double by) const {
    const Piece& obstacle = obstacles_[i];
    if (obstacle.cloud != nullptr) {
      const double reach = by + slack_;
      return cloud_distance(piece, pose, i, std::nextafter(reach, 2.0 * reach)) > reach;
    }
    if (piece.model == nullptr) return !meet_inflated(piece, pose, obstacle, obstacle.solid.pose, by);
    if (obstacle.model == nullptr) return !meet_inflated(obstacle, obstacle.solid.pose, piece, pose, by);
    const Turn place(inverses_[i] * pose);
    const double margin = std::max(by, slack_);
    TrianglePair guess;
    return compare_surfaces(*piece.surface, *obstacle.surface, place, margin, guess) == SurfacePair::apart;
  }

  [[nodiscard]] bool meet_inflated(const Piece& inflated, const Pose3& pose, const Piece& other,
                                   const Pose3& other_pose, double by) const {
    const Shape3 larger = std::visit(Inflate{by + slack_}, inflated.solid.shape);
    const Geometry geometry = std::visit(MakeGeometry(), scaled({larger, {}}, scale_).shape);
    result_.clear();
    return fcl::collide(geometry.get(), transform(pose, scale_), other.geometry.get(), transform(other_pose, scale_),
                        request_, result_) > 0;
  }

  /// Returns the parameter where the segment of a point's motion touches an obstacle; of other robots none.
  [[nodiscard]] std::optional<double> contact_between(View a, View b) const {
    if (!robot_.is_point()) return std::nullopt;
    const Vec3 from{a[0], a[1], a[2]};
    const Vec3 to{b[0], b[1], b[2]};
    const Segment3 segment{from, to - from};
    const Box3 box{least_of(from, to), greatest_of(from, to)};
    std::optional<double> found;
    tree_.each([&](const Box3& other) { return !found && overlap(box, other); },
               [&](std::uint32_t i) {
                 if (found || !overlap(box, boxes_[i])) return;
                 const Segment3 seen = seen_from(inverses_[i], segment);
                 const Piece& obstacle = obstacles_[i];
                 found = obstacle.model != nullptr   ? trellis::contact(seen, obstacle.model->distance, slack_)
                         : obstacle.cloud != nullptr ? trellis::contact(seen, *obstacle.cloud, slack_)
                                                     : trellis::contact(seen, obstacle.solid.shape, slack_);
               });
    return found;
  }

  /// Returns the distance of a point from the obstacles, in metres; `at_most` where it is not less.
  [[nodiscard]] double distance_of_point(const Vec3& p, double at_most) const {
    double best = at_most;
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
      if (gap_between({p, p}, boxes_[i]) >= best) continue;
      const Piece& obstacle = obstacles_[i];
      best = std::min(best, obstacle.model != nullptr ? obstacle.model->distance.to_surface(inverses_[i](p), best)
                                                      : distance_to(obstacle.solid, p));
    }
    return best;
  }

  /// Returns the distance of the robot at a free pose from the obstacles by FCL, in metres; `at_most` where it is not
  /// less.
  [[nodiscard]] double obstacle_distance(const Pose3& pose, double at_most) const {
    double best = at_most;
    fcl::DistanceRequestd request;
    for (const Piece& piece : pieces_) {
      const Pose3 at = pose * piece.solid.pose;
      const Box3 box = box_at(piece, Turn(at));
      const Transform3 frame = transform(at, scale_);
      for (std::size_t i = 0; i < obstacles_.size(); ++i) {
        if (gap_between(box, boxes_[i]) >= best) continue;
        if (obstacles_[i].cloud != nullptr) {
          best = std::max(std::min(best, cloud_distance(piece, at, i, best)), 0.0);
          continue;
        }
        fcl::DistanceResultd result;
        fcl::distance(piece.geometry.get(), frame, obstacles_[i].geometry.get(), frames_[i], request, result);
        best = std::min(best, result.min_distance / scale_);
      }
    }
    return best;
  }

  /// Returns a distance that the robot at a pose certainly has from all obstacles, 0 where it is unknown; -1 where it
  /// meets one.
  /// \param enough  the search for a larger distance may end at this one
  [[nodiscard]] double free_of_obstacles(const Pose3& pose, const Turn& turn, double enough) const {
    if (filter_) {
      const NearFilter::Answer answer = filter_->decide(turn, enough);
      if (answer.verdict == NearFilter::Verdict::free) return answer.clearance;
      if (answer.verdict == NearFilter::Verdict::meets) return -1.0;
    }
    const bool met = std::any_of(pieces_.begin(), pieces_.end(),
                                 [&](const Piece& piece) { return meets_any(piece, pose * piece.solid.pose); });
    return met ? -1.0 : 0.0;
  }

  [[nodiscard]] bool meets_any(const Piece& piece, const Pose3& pose) const {
    const Box3 box = box_at(piece, Turn(pose));
    const Transform3 frame = transform(pose, scale_);
    const auto meets = [&](std::size_t i) { return overlap(box, boxes_[i]) && meet(piece, pose, frame, i); };
    // Configurations that are checked one after the other often meet the same obstacle.
    const std::size_t before = last_met_;
    if (before < obstacles_.size() && meets(before)) return true;
    bool met = false;
    tree_.each([&](const Box3& other) { return !met && overlap(box, other); },
               [&](std::uint32_t i) {
                 if (met || i == before || !meets(i)) return;
                 met = true;
                 last_met_ = i;
               });
    return met;
  }

  /// Whether a piece of the robot at a pose meets the obstacle. FCL's meshes are surfaces: what lies wholly inside a
  /// closed one meets no triangle.
  [[nodiscard]] bool meet(const Piece& piece, const Pose3& pose, const Transform3& frame, std::size_t i) const {
    const Piece& obstacle = obstacles_[i];
    if (obstacle.cloud != nullptr) return cloud_distance(piece, pose, i, std::nextafter(slack_, 1.0)) <= slack_;
    if (surfaces_meet(piece, pose, frame, i)) return true;
    if (world_.surface()) return false;
    return (obstacle.has_inside() && lies_inside(piece, pose, obstacle, obstacle.solid.pose)) ||
           (piece.has_inside() && lies_inside(obstacle, obstacle.solid.pose, piece, pose));
  }

  /// As `meet`, where meshes have no inside: what FCL says.
  [[nodiscard]] bool surfaces_meet(const Piece& piece, const Pose3& pose, const Transform3& frame,
                                   std::size_t i) const {
    const Piece& obstacle = obstacles_[i];
    const bool triangles = piece.surface != nullptr && obstacle.surface != nullptr;
    if (filter_ && triangles && (piece.model != nullptr || obstacle.model != nullptr)) {
      const Turn place(inverses_[i] * pose);
      switch (compare_surfaces(*piece.surface, *obstacle.surface, place, filter_->margin(), guess_)) {
        case SurfacePair::meet: return true;
        case SurfacePair::apart:
          return holds_part(piece, pose, obstacle, obstacle.solid.pose) ||
                 holds_part(obstacle, obstacle.solid.pose, piece, pose);
        case SurfacePair::unknown: break;
      }
    }
    result_.clear();
    return fcl::collide(piece.collided().get(), frame, obstacle.geometry.get(), frames_[i], request_, result_) > 0;
  }

  std::shared_ptr<const Scene> scene_;
  const World3& world_;
  const Robot3& robot_;
  Space space_;
  double slack_ = 0.0;
  double scale_ = 1.0;            ///< of what FCL receives
  std::vector<Piece> obstacles_;  ///< with frames, their inverses, and boxes
  std::vector<Transform3> frames_;
  std::vector<Pose3> inverses_;
  std::vector<Box3> boxes_;
  BoxTree tree_;               ///< of the boxes
  std::vector<Piece> pieces_;  ///< of the robot
  std::optional<NearFilter> filter_;
  fcl::CollisionRequestd request_;

  // The motion that has begun, or is certified.
  View a_;
  View b_;
  std::uint32_t n_ = 0;
  double displacement_ = 0.0;
  std::vector<char> free_;  ///< by index: whether the clearance of another configuration shows that this one is free
  std::optional<Clearances> clearances_;

  // Scratch.
  mutable fcl::CollisionResultd result_;
  mutable TrianglePair guess_;        ///< of the meshes that met last
  mutable std::size_t last_met_ = 0;  ///< an obstacle
  mutable Configuration q_;
};

}  // namespace

BodyMotion body_motion(const Pose3& from, const Pose3& to) {
  BodyMotion motion{{}, to.position - from.position, {}, 0.0};
  const Vec3 turn = from.orientation(rotation_vector(from.orientation.inverse() * to.orientation));
  motion.turn = norm(turn);
  if (motion.turn > 0.0) motion.axis = 1.0 / motion.turn * turn;
  return motion;
}

std::unique_ptr<BodyPhase> make_body_phase(std::shared_ptr<const Scene> scene, const Space& space, bool filtered) {
  return std::make_unique<FclBodyPhase>(std::move(scene), space, filtered);
}

std::unique_ptr<Checker> make_spatial_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution,
                                              bool filtered) {
  check_fits(*scene, space, resolution);
  const Scene& checked = *scene;
  std::unique_ptr<NarrowPhase> phase;
  if (spatial(checked).robot.members().empty()) {
    phase = make_body_phase(std::move(scene), space, filtered);
  } else {
    phase = make_team_phase(std::move(scene), space, filtered);
  }
  return std::make_unique<Checker>(checked, std::move(phase), resolution);
}

}  // namespace trellis
