// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/shapes.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <trellis/base/error.hpp>
#include <trellis/scene/precision.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

/// The direction of the frame's z axis, in the frame of the pose.
Vec3 axis_of(const Pose3& pose) { return pose.orientation({0.0, 0.0, 1.0}); }

Box3 about(const Vec3& centre, const Vec3& half) { return {centre - half, centre + half}; }

struct Check {
  const std::string& what;
  bool point;

  void size(const char* shape, const char* name, double value, bool zero = false) const {
    if (value <= most_distant && (value > 0.0 || (zero && value == 0.0))) return;
    throw Error(fmt::format("{}: a {} needs a {} {} 0 and at most {:g} m, got {}", what, shape, name,
                            zero ? "of at least" : "greater than", most_distant, value));
  }
  void operator()(const Sphere& s) const { size("sphere", "radius", s.radius, point); }
  void operator()(const Cuboid& s) const {
    size("box", "length along x", s.size.x);
    size("box", "length along y", s.size.y);
    size("box", "length along z", s.size.z);
  }
  void operator()(const Cylinder& s) const {
    size("cylinder", "radius", s.radius);
    size("cylinder", "length", s.length);
  }
  void operator()(const Capsule& s) const {
    size("capsule", "radius", s.radius);
    size("capsule", "length", s.length);
  }
  void operator()(const std::shared_ptr<const Mesh>& mesh) const {
    if (mesh == nullptr) throw Error(fmt::format("{}: it has no mesh", what));
  }
  void operator()(const std::shared_ptr<const PointCloud>& cloud) const {
    if (cloud == nullptr) throw Error(fmt::format("{}: it has no points", what));
  }
};

struct Bounds {
  const Pose3& pose;

  Box3 operator()(const Sphere& s) const { return about(pose.position, {s.radius, s.radius, s.radius}); }
  Box3 operator()(const Cuboid& s) const {
    const Vec3 x = pose.orientation({0.5 * s.size.x, 0.0, 0.0});
    const Vec3 y = pose.orientation({0.0, 0.5 * s.size.y, 0.0});
    const Vec3 z = pose.orientation({0.0, 0.0, 0.5 * s.size.z});
    return about(pose.position,
                 {std::abs(x.x) + std::abs(y.x) + std::abs(z.x), std::abs(x.y) + std::abs(y.y) + std::abs(z.y),
                  std::abs(x.z) + std::abs(y.z) + std::abs(z.z)});
  }
  Box3 operator()(const Cylinder& s) const {
    const Vec3 axis = axis_of(pose);
    const auto half = [&](double along, double first, double second) {
      return 0.5 * s.length * std::abs(along) + s.radius * std::hypot(first, second);
    };
    return about(pose.position,
                 {half(axis.x, axis.y, axis.z), half(axis.y, axis.z, axis.x), half(axis.z, axis.x, axis.y)});
  }
  Box3 operator()(const Capsule& s) const {
    const Vec3 end = 0.5 * s.length * axis_of(pose);
    return about(pose.position,
                 Vec3{std::abs(end.x), std::abs(end.y), std::abs(end.z)} + Vec3{s.radius, s.radius, s.radius});
  }
  Box3 operator()(const std::shared_ptr<const Mesh>& mesh) const {
    const Vec3 first = pose(mesh->vertices().front());
    Box3 box{first, first};
    for (const Vec3& v : mesh->vertices()) {
      const Vec3 p = pose(v);
      box = {least_of(box.lo, p), greatest_of(box.hi, p)};
    }
    return box;
  }
  Box3 operator()(const std::shared_ptr<const PointCloud>& cloud) const {
    if (pose.orientation == Quaternion{}) {
      return {cloud->bounds().lo + pose.position, cloud->bounds().hi + pose.position};
    }
    const Vec3 first = pose(cloud->points().front());
    Box3 box{first, first};
    for (const Vec3& point : cloud->points()) {
      const Vec3 p = pose(point);
      box = {least_of(box.lo, p), greatest_of(box.hi, p)};
    }
    const Vec3 margin{cloud->radius(), cloud->radius(), cloud->radius()};
    return {box.lo - margin, box.hi + margin};
  }
};

/// Of a shape, from a point of its frame.
struct Farthest {
  Vec3 from;

  double operator()(const Sphere& s) const { return norm(from) + s.radius; }
  double operator()(const Cuboid& s) const {
    return norm(
        {std::abs(from.x) + 0.5 * s.size.x, std::abs(from.y) + 0.5 * s.size.y, std::abs(from.z) + 0.5 * s.size.z});
  }
  double operator()(const Cylinder& s) const {
    return std::hypot(std::hypot(from.x, from.y) + s.radius, std::abs(from.z) + 0.5 * s.length);
  }
  double operator()(const Capsule& s) const {
    return norm({from.x, from.y, std::abs(from.z) + 0.5 * s.length}) + s.radius;
  }
  double operator()(const std::shared_ptr<const Mesh>& mesh) const {
    double radius = 0.0;
    for (const Vec3& v : mesh->vertices()) radius = std::max(radius, norm(v - from));
    return radius;
  }
  double operator()(const std::shared_ptr<const PointCloud>& cloud) const {
    double radius = 0.0;
    for (const Vec3& p : cloud->points()) radius = std::max(radius, norm(p - from));
    return radius + cloud->radius();
  }
};

struct Scaled {
  double factor;

  Shape3 operator()(const Sphere& s) const { return Sphere{factor * s.radius}; }
  Shape3 operator()(const Cuboid& s) const { return Cuboid{factor * s.size}; }
  Shape3 operator()(const Cylinder& s) const { return Cylinder{factor * s.radius, factor * s.length}; }
  Shape3 operator()(const Capsule& s) const { return Capsule{factor * s.radius, factor * s.length}; }
  Shape3 operator()(const std::shared_ptr<const Mesh>& mesh) const {
    return std::make_shared<const Mesh>(mesh->scaled(factor));
  }
  Shape3 operator()(const std::shared_ptr<const PointCloud>& cloud) const {
    return std::make_shared<const PointCloud>(cloud->scaled(factor));
  }
};

/// The distance of a point of the shape's frame.
struct Distance {
  const Vec3& p;

  double operator()(const Sphere& s) const { return std::max(0.0, norm(p) - s.radius); }
  double operator()(const Cuboid& s) const {
    return norm({std::max(0.0, std::abs(p.x) - 0.5 * s.size.x), std::max(0.0, std::abs(p.y) - 0.5 * s.size.y),
                 std::max(0.0, std::abs(p.z) - 0.5 * s.size.z)});
  }
  double operator()(const Cylinder& s) const {
    const double beside = std::max(0.0, std::hypot(p.x, p.y) - s.radius);
    return std::hypot(beside, std::max(0.0, std::abs(p.z) - 0.5 * s.length));
  }
  double operator()(const Capsule& s) const {
    return std::max(0.0, norm({p.x, p.y, std::max(0.0, std::abs(p.z) - 0.5 * s.length)}) - s.radius);
  }
  double operator()(const std::shared_ptr<const Mesh>& mesh) const {
    return contains(*mesh, p) ? 0.0 : distance_to_surface(*mesh, p);
  }
  double operator()(const std::shared_ptr<const PointCloud>& cloud) const {
    return std::max(0.0, cloud->nearest(p).distance - cloud->radius());
  }
};

/// Checks the sizes of a shape.
struct Precision {
  const std::string& what;
  double farthest;

  void operator()(const Sphere& s) const {
    if (s.radius > 0.0) size("diameter", 2.0 * s.radius);
  }
  void operator()(const Cuboid& s) const {
    size("length along x", s.size.x);
    size("length along y", s.size.y);
    size("length along z", s.size.z);
  }
  void operator()(const Cylinder& s) const {
    size("diameter", 2.0 * s.radius);
    size("length", s.length);
  }
  void operator()(const Capsule& s) const { size("diameter", 2.0 * s.radius); }
  void operator()(const std::shared_ptr<const Mesh>& mesh) const {
    const Vec3 extent = mesh->bounds().hi - mesh->bounds().lo;
    size("extent", std::max({extent.x, extent.y, extent.z}));
  }
  void operator()(const std::shared_ptr<const PointCloud>& cloud) const {
    size("diameter of points", 2.0 * cloud->radius());
  }
  void size(const char* name, double value) const { check_size(value, farthest, name, what); }
};

}  // namespace

double farthest_of(const Box3& box) {
  return std::max({std::abs(box.lo.x), std::abs(box.lo.y), std::abs(box.lo.z), std::abs(box.hi.x), std::abs(box.hi.y),
                   std::abs(box.hi.z)});
}

void check_precision(const Solid& solid, double farthest, const std::string& what) {
  std::visit(Precision{what, farthest}, solid.shape);
}

void check_solid(const Solid& solid, const std::string& what, bool point) {
  std::visit(Check{what, point}, solid.shape);
  const Vec3& p = solid.pose.position;
  if (!in_range(p)) {
    throw Error(fmt::format("{}: its position must lie within {:g} m of 0 in x, y and z, got ({}, {}, {})", what,
                            most_distant, p.x, p.y, p.z));
  }
  const Quaternion& q = solid.pose.orientation;
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  constexpr double rounding = 1e-9;
  if (!(std::abs(length - 1.0) <= rounding)) {
    throw Error(
        fmt::format("{}: its orientation must be a quaternion of norm 1, got x y z w = ({}, {}, {}, {}) of norm "
                    "{}",
                    what, q.x, q.y, q.z, q.w, length));
  }
  check_precision(solid, farthest_of(bounding_box(solid)), what);
}

void check_no_cloud(const Solid& solid, const std::string& what) {
  if (!std::holds_alternative<std::shared_ptr<const PointCloud>>(solid.shape)) return;
  throw Error(fmt::format("{}: a cloud of points can be an obstacle, no part of a robot", what));
}

Box3 bounding_box(const Solid& solid) { return std::visit(Bounds{solid.pose}, solid.shape); }

double farthest_from_origin(const Solid& solid) {
  return std::visit(Farthest{solid.pose.inverse().position}, solid.shape);
}

double distance_to(const Solid& solid, const Vec3& p) {
  const Vec3 local = solid.pose.inverse()(p);
  return std::visit(Distance{local}, solid.shape);
}

Solid scaled(const Solid& solid, double factor) {
  return {std::visit(Scaled{factor}, solid.shape), {factor * solid.pose.position, solid.pose.orientation}};
}

}  // namespace trellis
