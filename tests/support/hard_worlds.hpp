// SPDX-License-Identifier: GPL-3.0-or-later
// Random worlds and robots that are hard for collision checks of motions: slivers, thin plates, shapes that touch each
// other. The same stream gives the same ones.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>

#include "unit/scene_spatial.hpp"

namespace trellis::test {

/// From the generators' coordinates of 10 m to those of a world: scaled, then moved.
struct Placement {
  double scale = 1.0;
  double shift = 0.0;  ///< along each axis

  [[nodiscard]] Vec2 operator()(Vec2 p) const { return scale * p + Vec2{shift, shift}; }
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return scale * p + Vec3{shift, shift, shift}; }
};

/// Worlds of 1 to 100 m, some of them far from the origin or about it.
inline Placement random_placement(Stream& stream) {
  static constexpr std::array scales = {0.1, 1.0, 10.0};
  static constexpr std::array shifts = {0.0, 0.0, -5.0, 1000.0};
  Placement placement;
  placement.scale = scales[stream.below(scales.size())];
  placement.shift = placement.scale * shifts[stream.below(shifts.size())];
  return placement;
}

/// 10 to a uniform exponent.
inline double magnitude_between(Stream& stream, double least, double greatest) {
  return std::pow(10.0, stream.uniform(least, greatest));
}

// The plane: worlds of 10 m, then scaled.

class HardWorld {
 public:
  static const std::vector<std::string>& kinds() {
    static const std::vector<std::string> all = {"slivers", "plates",   "rotated plates", "cells", "comb",
                                                 "spiral",  "diagonal", "touching discs", "hooks", "crossings"};
    return all;
  }

  static World make(const std::string& kind, Stream& stream, const Placement& placement) {
    HardWorld world(stream, placement);
    if (kind == "slivers") world.slivers();
    if (kind == "plates") world.plates(false);
    if (kind == "rotated plates") world.plates(true);
    if (kind == "cells") world.cells();
    if (kind == "comb") world.comb();
    if (kind == "spiral") world.spiral();
    if (kind == "diagonal") world.diagonal();
    if (kind == "touching discs") world.discs();
    if (kind == "hooks") world.hooks();
    if (kind == "crossings") world.crossings();
    return {Box2{placement(Vec2{0, 0}), placement(Vec2{side, side})}, std::move(world.obstacles_)};
  }

 private:
  static constexpr double side = 10.0;

  HardWorld(Stream& stream, const Placement& placement) : stream_(stream), place_(placement) {}

  [[nodiscard]] Vec2 anywhere() {
    const double x = stream_.uniform(0, side), y = stream_.uniform(0, side);
    return {x, y};
  }
  void add(Shape shape) { obstacles_.push_back({fmt::format("obstacle {}", obstacles_.size()), std::move(shape)}); }
  void box(double xmin, double ymin, double xmax, double ymax) {
    add(Box2{place_(Vec2{xmin, ymin}), place_(Vec2{xmax, ymax})});
  }
  void polygon(std::vector<Vec2> vertices) {
    for (Vec2& v : vertices) v = place_(v);
    add(Polygon{std::move(vertices)});
  }
  /// A rectangle about the segment from p along `angle`.
  void plate(Vec2 p, double angle, double length, double width) {
    const Vec2 u{length * std::cos(angle), length * std::sin(angle)};
    const Vec2 n{-width * std::sin(angle), width * std::cos(angle)};
    polygon({p, p + u, p + u + n, p + n});
  }

  void slivers() {
    const std::size_t count = 8 + stream_.below(20);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2 p = anywhere();
      const double angle = stream_.uniform(0, 2 * std::numbers::pi), length = stream_.uniform(1, 6);
      const double width = magnitude_between(stream_, -6, -2), at = stream_.uniform();
      const Vec2 u{std::cos(angle), std::sin(angle)}, n{-u.y, u.x};
      polygon({p, p + length * u, p + at * length * u + width * n});
    }
  }

  void plates(bool rotated) {
    const std::size_t count = 8 + stream_.below(16);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2 p = anywhere();
      const double length = stream_.uniform(1, 6), width = magnitude_between(stream_, -6, -2);
      if (rotated) {
        plate(p, stream_.uniform(0, 2 * std::numbers::pi), length, width);
      } else if (stream_.below(2) == 0) {
        box(p.x, p.y, p.x + length, p.y + width);
      } else {
        box(p.x, p.y, p.x + width, p.y + length);
      }
    }
  }

  /// Cells of a grid, which touch at edges and corners.
  void cells() {
    const std::size_t n = 5 + stream_.below(8);
    const double share = stream_.uniform(0.25, 0.45), size = side / static_cast<double>(n);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < n; ++k) {
        if (stream_.uniform() > share) continue;
        const auto x = static_cast<double>(i), y = static_cast<double>(k);
        box(x * size, y * size, (x + 1) * size, (y + 1) * size);
      }
    }
  }

  void comb() {
    const std::size_t teeth = 2 + stream_.below(6);
    const double width = magnitude_between(stream_, -6, -1.5);
    for (std::size_t i = 0; i < teeth; ++i) {
      const double x = side * static_cast<double>(i + 1) / static_cast<double>(teeth + 1);
      const double gap = stream_.uniform(0.8, 2.5);
      if (i % 2 == 0) {
        box(x, 0, x + width, side - gap);
      } else {
        box(x, gap, x + width, side);
      }
    }
  }

  /// Walls of a spiral; each touches the one before in a corner or along an edge.
  void spiral() {
    const double width = magnitude_between(stream_, -6, -1.5), pitch = stream_.uniform(1.2, 2.0);
    double low = 1.0, high = 9.0, x = 1.0, y = 1.0;
    for (int turn = 0; high - low > 2.5 * pitch && turn < 4; ++turn) {
      const double right = high, top = high, left = low, bottom = low + pitch;
      box(x, y, right, y + width);
      box(right, y, right + width, top);
      box(left, top, right, top + width);
      box(left, bottom, left + width, top);
      x = left;
      y = bottom;
      low += pitch;
      high -= pitch;
      box(x, y, low, y + width);
      x = low;
    }
  }

  /// A wall of pixels that touch in their corners, closed or with a gap.
  void diagonal() {
    const std::size_t n = 8 + stream_.below(40);
    const double size = side / static_cast<double>(n);
    const std::size_t missing = stream_.below(3) == 0 ? n : stream_.below(n), gap = 1 + stream_.below(n / 4);
    for (std::size_t i = 0; i < n; ++i) {
      if (i >= missing && i < missing + gap) continue;
      const auto x = static_cast<double>(i), y = static_cast<double>(n - 1 - i);
      box(x * size, y * size, (x + 1) * size, (y + 1) * size);
    }
  }

  /// Rows of discs whose radii are binary fractions, so that they touch exactly.
  void discs() {
    const std::size_t rows = 2 + stream_.below(4);
    for (std::size_t i = 0; i < rows; ++i) {
      const double radius = std::ldexp(1.0, -1 - static_cast<int>(stream_.below(3)));
      const double fixed = std::ldexp(std::floor(stream_.uniform(4, 60)), -3);
      const std::size_t count = static_cast<std::size_t>(side / (2 * radius)), missing = stream_.below(count + 1);
      const bool upright = stream_.below(2) == 0;
      for (std::size_t k = 0; k < count; ++k) {
        if (k >= missing && k < missing + 2 + count / 8) continue;
        const double along = radius * static_cast<double>(2 * k + 1);
        add(Disc{place_(upright ? Vec2{fixed, along} : Vec2{along, fixed}), place_.scale * radius});
      }
    }
  }

  /// Polygons that are not convex, with thin arms.
  void hooks() {
    const std::size_t count = 5 + stream_.below(8);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2 p = anywhere();
      const double a = stream_.uniform(0.8, 3), b = stream_.uniform(0.8, 3), w = magnitude_between(stream_, -5, -1.5);
      const double angle = stream_.uniform(0, 2 * std::numbers::pi), c = std::cos(angle), s = std::sin(angle);
      std::vector<Vec2> vertices = {{0, 0}, {a, 0}, {a, w}, {w, w}, {w, b}, {0, b}};
      for (Vec2& v : vertices) v = {p.x + c * v.x - s * v.y, p.y + s * v.x + c * v.y};
      polygon(std::move(vertices));
    }
  }

  /// Thin plates across the whole world, with doors.
  void crossings() {
    const std::size_t count = 2 + stream_.below(4);
    for (std::size_t i = 0; i < count; ++i) {
      const double at = stream_.uniform(1, 9), width = magnitude_between(stream_, -6, -2);
      const double door = stream_.uniform(0, 8.5), wide = stream_.uniform(0.8, 1.5);
      if (stream_.below(2) == 0) {
        box(at, 0, at + width, door);
        box(at, door + wide, at + width, side);
      } else {
        box(0, at, door, at + width);
        box(door + wide, at, side, at + width);
      }
    }
  }

  Stream& stream_;
  Placement place_;
  std::vector<Obstacle> obstacles_;
};

struct HardRobot {
  std::string kind;
  Robot robot;
  std::vector<std::vector<Shape>> bodies;  ///< its shapes as given, body by body
};

inline const std::vector<std::string>& hard_robot_kinds() {
  static const std::vector<std::string> all = {
      "point", "disc",  "bar",  "bar, not turning", "needle", "ell", "ell, not turning", "off-centre bar",
      "arm 2", "arm 3", "arm 4"};
  return all;
}

inline HardRobot hard_robot(const std::string& kind, Stream& stream, const Placement& placement) {
  const double scale = placement.scale;
  const auto rigid = [&kind](Shape shape, bool rotates) {
    return HardRobot{kind, Robot::rigid({shape}, rotates), {{shape}}};
  };
  const auto rectangle = [scale](double xmin, double ymin, double xmax, double ymax) {
    return Shape(Box2{scale * Vec2{xmin, ymin}, scale * Vec2{xmax, ymax}});
  };
  if (kind == "point") return {kind, Robot::point(), {{Disc{}}}};
  if (kind == "disc") {
    const double radius = scale * magnitude_between(stream, -3, -0.5);
    return {kind, Robot::disc(radius), {{Disc{{}, radius}}}};
  }
  const double length = stream.uniform(0.2, 0.8), width = magnitude_between(stream, -2, -1);
  if (kind == "bar") return rigid(rectangle(-length, -width, length, width), true);
  if (kind == "bar, not turning") return rigid(rectangle(-length, -width, length, width), false);
  if (kind == "needle") return rigid(rectangle(-length, -1e-4, length, 1e-4), true);
  if (kind == "off-centre bar") return rigid(rectangle(0.5 * length, -width, 2 * length, width), true);
  if (kind.starts_with("ell")) {
    Polygon ell{{{-0.3, -0.3}, {0.5, -0.3}, {0.5, -0.2}, {-0.2, -0.2}, {-0.2, 0.4}, {-0.3, 0.4}}};
    for (Vec2& v : ell.vertices) v = scale * v;
    return rigid(ell, kind == "ell");
  }
  Arm arm;
  const std::size_t links = static_cast<std::size_t>(kind.back() - '0');
  for (std::size_t i = 0; i < links; ++i) {
    arm.links.push_back(scale * stream.uniform(3.0, 4.5) / static_cast<double>(links));
    arm.widths.push_back(scale * magnitude_between(stream, -2, -1));
    arm.limits.emplace_back();
    if (i > 0 && stream.below(2) == 0) arm.limits.back() = {-2.6, 2.6};
  }
  arm.base = placement(Vec2{5, 5});
  std::vector<std::vector<Shape>> bodies;
  for (std::size_t i = 0; i < links; ++i) {
    const double half = 0.5 * arm.widths[i];
    bodies.push_back({Box2{{0, -half}, {arm.links[i], half}}});
  }
  return {kind, Robot::arm(arm), std::move(bodies)};
}

// Space: worlds of 10 m, then scaled.

class HardWorld3 {
 public:
  static const std::vector<std::string>& kinds() {
    static const std::vector<std::string> all = {"plates", "rotated plates", "slivers",      "cells",
                                                 "doors",  "touching balls", "mixed solids", "hollow meshes"};
    return all;
  }

  static World3 make(const std::string& kind, Stream& stream, const Placement& placement) {
    HardWorld3 world(stream, placement);
    if (kind == "plates") world.plates(false);
    if (kind == "rotated plates") world.plates(true);
    if (kind == "slivers") world.slivers();
    if (kind == "cells") world.cells();
    if (kind == "doors") world.doors();
    if (kind == "touching balls") world.balls();
    if (kind == "mixed solids") world.mixed();
    if (kind == "hollow meshes") world.meshes();
    return {Box3{placement(Vec3{0, 0, 0}), placement(Vec3{side, side, side})}, std::move(world.obstacles_)};
  }

 private:
  static constexpr double side = 10.0;

  HardWorld3(Stream& stream, const Placement& placement) : stream_(stream), place_(placement) {}

  [[nodiscard]] Vec3 anywhere() {
    const double x = stream_.uniform(0, side), y = stream_.uniform(0, side), z = stream_.uniform(0, side);
    return {x, y, z};
  }
  [[nodiscard]] Quaternion any_rotation() {
    const double u = stream_.uniform(), v = stream_.uniform(), w = stream_.uniform();
    return rotation_from_unit({u, v, w});
  }
  void add(Shape3 shape, const Vec3& at, const Quaternion& turn = {}) {
    obstacles_.push_back({fmt::format("obstacle {}", obstacles_.size()), {std::move(shape), {place_(at), turn}}});
  }
  void box(const Vec3& lo, const Vec3& hi) { add(Cuboid{place_.scale * (hi - lo)}, 0.5 * (lo + hi)); }

  void plates(bool rotated) {
    const std::size_t count = 10 + stream_.below(20);
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, 3> size{};
      for (double& s : size) s = stream_.uniform(1, 6);
      size[stream_.below(3)] = magnitude_between(stream_, -5, -2);
      const Vec3 at = anywhere();
      add(Cuboid{place_.scale * Vec3{size[0], size[1], size[2]}}, at, rotated ? any_rotation() : Quaternion{});
    }
  }

  void slivers() {
    const std::size_t count = 10 + stream_.below(15);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 at = anywhere();
      const double thin = magnitude_between(stream_, -5, -2);
      const Quaternion turn = any_rotation();
      std::vector<Vec3> vertices = {{0, 0, 0},
                                    {stream_.uniform(1, 5), 0, 0},
                                    {stream_.uniform(0, 3), 3, 0},
                                    {stream_.uniform(0, 3), stream_.uniform(0, 2), thin}};
      // Some by their vertices, some by their pose.
      const bool posed = stream_.below(2) == 0;
      for (Vec3& v : vertices) v = posed ? place_.scale * v : place_(turn(v) + at);
      const Pose3 pose = posed ? Pose3{place_(at), turn} : Pose3{};
      obstacles_.push_back(
          {fmt::format("obstacle {}", i), {std::make_shared<const Mesh>(Mesh::hull(vertices, "sliver")), pose}});
    }
  }

  void cells() {
    const std::size_t n = 3 + stream_.below(3);
    const double share = stream_.uniform(0.2, 0.4), size = side / static_cast<double>(n);
    for (std::size_t cell = 0; cell < n * n * n; ++cell) {
      if (stream_.uniform() > share) continue;
      const auto x = static_cast<double>(cell % n), y = static_cast<double>(cell / n % n);
      const auto z = static_cast<double>(cell / n / n);
      box({x * size, y * size, z * size}, {(x + 1) * size, (y + 1) * size, (z + 1) * size});
    }
  }

  /// Thin walls across the world, each of four plates around a door that touch each other.
  void doors() {
    const std::size_t count = 1 + stream_.below(3);
    for (std::size_t i = 0; i < count; ++i) {
      const double x = side * static_cast<double>(i + 1) / static_cast<double>(count + 1);
      const double end = x + magnitude_between(stream_, -5, -2);
      const double y = stream_.uniform(1, 6), z = stream_.uniform(1, 6), wide = stream_.uniform(1.5, 2.5);
      box({x, 0, 0}, {end, y, side});
      box({x, y + wide, 0}, {end, side, side});
      box({x, y, 0}, {end, y + wide, z});
      box({x, y, z + wide}, {end, y + wide, side});
    }
  }

  void balls() {
    const double radius = std::ldexp(1.0, -1 + static_cast<int>(stream_.below(2)));
    const auto count = static_cast<std::size_t>(side / (2 * radius));
    const double fixed = std::ldexp(std::floor(stream_.uniform(16, 60)), -3);
    for (std::size_t i = 0; i < count * count; ++i) {
      if (stream_.uniform() < 0.1) continue;
      const double y = radius * static_cast<double>(2 * (i % count) + 1);
      const double z = radius * static_cast<double>(2 * (i / count) + 1);
      add(Sphere{place_.scale * radius}, {fixed, y, z});
    }
  }

  void mixed() {
    const std::size_t count = 10 + stream_.below(15);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 at = anywhere();
      const Quaternion turn = any_rotation();
      const double thin = magnitude_between(stream_, -4, -0.5), length = stream_.uniform(1, 5);
      switch (stream_.below(5)) {
        case 0: add(Cylinder{place_.scale * thin, place_.scale * length}, at, turn); break;
        case 1: add(Cylinder{place_.scale * 0.5 * length, place_.scale * thin}, at, turn); break;
        case 2: add(Capsule{place_.scale * thin, place_.scale * length}, at, turn); break;
        case 3: add(Sphere{place_.scale * thin}, at); break;
        default: add(Cuboid{place_.scale * Vec3{thin, length, thin}}, at, turn); break;
      }
    }
  }

  /// Closed meshes that are not convex: tori and boxes that share no face.
  void meshes() {
    const std::size_t count = 3 + stream_.below(4);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 at = anywhere();
      const Quaternion turn = any_rotation();
      spatial_tests::Soup soup;
      if (stream_.below(2) == 0) {
        const double large = stream_.uniform(0.8, 2.0), small = magnitude_between(stream_, -2.5, -0.5);
        soup = spatial_tests::torus(large, small, 8, 4);
      } else {
        const double thin = magnitude_between(stream_, -4, -1);
        soup = spatial_tests::box({-1.5, -1.5, -thin}, {1.5, 1.5, thin});
        soup.append(spatial_tests::box({-1.5, -thin, 0.5}, {1.5, thin, 2.5}));
      }
      for (Vec3& v : soup.vertices) v = place_(turn(v) + at);
      obstacles_.push_back({fmt::format("obstacle {}", i), {std::make_shared<const Mesh>(soup.mesh()), {}}});
    }
  }

  Stream& stream_;
  Placement place_;
  std::vector<Obstacle3> obstacles_;
};

inline const std::vector<std::string>& hard_body_kinds() {
  static const std::vector<std::string> all = {"point",    "ball", "box, not turning", "box", "thin bar",
                                               "two bars", "rod"};
  return all;
}

inline Robot3 hard_body(const std::string& kind, Stream& stream, double scale) {
  const auto solid = [scale](const Vec3& size, const Vec3& at = {}) {
    return Solid{Cuboid{scale * size}, {scale * at, {}}};
  };
  if (kind == "point") return Robot3::point();
  if (kind == "ball") {
    return {kind, {Solid{Sphere{scale * magnitude_between(stream, -3, -0.4)}, {}}}, false};
  }
  const double length = stream.uniform(0.4, 1.5), thin = magnitude_between(stream, -3, -1);
  if (kind == "box, not turning") return {kind, {solid({length, 0.5, 0.3})}, false};
  if (kind == "box") return {kind, {solid({length, 0.5, 0.3})}, true};
  if (kind == "thin bar") return {kind, {solid({2 * length, thin, thin})}, true};
  if (kind == "two bars") {
    return {
        kind, {solid({length, 0.1, 0.1}, {0.5 * length, 0, 0}), solid({0.1, 0.1, length}, {0, 0, 0.5 * length})}, true};
  }
  return {kind, {Solid{Capsule{scale * thin, scale * length}, {}}}, true};
}

}  // namespace trellis::test
