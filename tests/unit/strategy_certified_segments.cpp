// SPDX-License-Identifier: GPL-3.0-or-later
// The motions of a point are segments, which checkers test exactly, at any resolution: a segment that touches a closed
// obstacle is invalid, one that passes at more than the touching slack is valid. Most of the segments here graze:
// through corners, along edges, and off them by multiples of the slack.
//
// TRELLIS_PATHS sets the number of segments of each kind of world, in hundreds.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <trellis/collision/checker.hpp>

#include "support/catch.hpp"
#include "support/hard_worlds.hpp"
#include "support/path_judge.hpp"

using namespace trellis;
using namespace trellis::test;

namespace {

std::size_t segments(std::size_t by_default) {
  const char* set = std::getenv("TRELLIS_PATHS");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  return set != nullptr ? 100 * std::strtoull(set, nullptr, 10) : by_default;
}

struct Counts {
  std::size_t free = 0;
  std::size_t hit = 0;
  std::size_t either = 0;
  std::size_t passed = 0;   ///< that touch an obstacle and were valid
  std::size_t refused = 0;  ///< that are free and were invalid
  std::vector<std::string> differences = {};
};

/// The backends of a scene, compared with the judge.
class Comparison {
 public:
  Comparison(const std::shared_ptr<const Scene>& scene, double resolution)
      : judge_(scene, scene->default_space(1.0)), backends_(collision_backends(*scene)) {
    for (const std::string& backend : backends_) {
      checkers_.push_back(make_checker(backend, scene, scene->default_space(1.0), resolution));
    }
  }

  void compare(const Configuration& a, const Configuration& b, Counts& counts) const {
    // The caller of a checker validates the beginning of a motion.
    if (judge_.motion(a, a).verdict != Verdict::free) return;
    const Judgement judgement = judge_.motion(a, b);
    const bool free = judgement.verdict == Verdict::free, either = judgement.verdict == Verdict::undecided;
    ++(free ? counts.free : either ? counts.either : counts.hit);
    for (std::size_t i = 0; i < checkers_.size(); ++i) {
      const bool valid = checkers_[i]->motion(a, b).valid;
      if (either || valid == free) continue;
      ++(free ? counts.refused : counts.passed);
      constexpr std::size_t most_reported = 5;
      if (counts.differences.size() >= most_reported) continue;
      counts.differences.push_back(fmt::format("{}: from ({:.17g}) to ({:.17g}) is {}, and {} {}", backends_[i],
                                               fmt::join(a, ", "), fmt::join(b, ", "), valid ? "valid" : "invalid",
                                               free ? "free" : "touches", judgement.what));
    }
  }

 private:
  PathJudge judge_;
  std::vector<std::string> backends_;
  std::vector<std::unique_ptr<Checker>> checkers_;
};

void report(const std::string& kind, const Counts& counts) {
  if (std::getenv("TRELLIS_PATHS") != nullptr) {  // NOLINT(concurrency-mt-unsafe): nothing here sets it
    fmt::print(
        "{:<16} free {:>8}, touching {:>8}, within the slack {:>7}; touching but valid {:>6}, free but invalid {:>6}\n",
        kind, counts.free, counts.hit, counts.either, counts.passed, counts.refused);
  }
  for (const std::string& difference : counts.differences) UNSCOPED_INFO(kind + ": " + difference);
  CHECK(counts.differences.empty());
  CHECK(counts.free > 100);
  CHECK(counts.hit > 100);
}

/// Metres off a corner or an edge: nothing, about the slack, or more.
double offset(Stream& stream, double slack) {
  static constexpr std::array multiples = {0.0, 0.0, 0.3, 1.0, 3.0, 10.0, 1e3, 1e6};
  const double by = slack * multiples[stream.below(multiples.size())];
  return stream.below(2) == 0 ? by : -by;
}

std::vector<Vec2> vertices_of(const World& world) {
  std::vector<Vec2> all;
  for (const auto& obstacle : world.obstacles()) {
    if (const auto* box = std::get_if<Box2>(&obstacle.shape)) {
      for (const Vec2 v : rectangle_vertices(*box)) all.push_back(v);
    } else if (const auto* polygon = std::get_if<Polygon>(&obstacle.shape)) {
      all.insert(all.end(), polygon->vertices.begin(), polygon->vertices.end());
    } else {
      const Disc& disc = std::get<Disc>(obstacle.shape);
      for (const Vec2 side : {Vec2{1, 0}, Vec2{0, 1}, Vec2{-1, 0}, Vec2{0, -1}}) {
        all.push_back(disc.centre + disc.radius * side);
      }
    }
  }
  return all;
}

/// Two points whose segment often passes a corner or runs along an edge.
std::pair<Configuration, Configuration> grazing(Stream& stream, const std::vector<Vec2>& vertices, const Box2& bounds,
                                                double slack) {
  const Vec2 size = bounds.hi - bounds.lo;
  const auto anywhere = [&] {
    const double x = stream.uniform(bounds.lo.x, bounds.hi.x), y = stream.uniform(bounds.lo.y, bounds.hi.y);
    return Vec2{x, y};
  };
  const auto clamped = [&bounds](Vec2 p) {
    return Configuration{std::clamp(p.x, bounds.lo.x, bounds.hi.x), std::clamp(p.y, bounds.lo.y, bounds.hi.y)};
  };
  const Vec2 v = vertices[stream.below(vertices.size())];
  Vec2 a = anywhere(), b = anywhere();
  switch (stream.below(6)) {
    case 0: break;
    case 1: {  // through one corner
      b = v + stream.uniform(0.05, 1.0) * (v - a);
      break;
    }
    case 2: {  // through two
      const Vec2 w = vertices[stream.below(vertices.size())];
      a = v + stream.uniform(0.05, 1.0) * (v - w);
      b = w + stream.uniform(0.05, 1.0) * (w - v);
      break;
    }
    case 3:  // upright through a corner
      a = {v.x + offset(stream, slack), stream.uniform(bounds.lo.y, bounds.hi.y)};
      b = {a.x, stream.uniform(bounds.lo.y, bounds.hi.y)};
      break;
    case 4:  // level through a corner
      a = {stream.uniform(bounds.lo.x, bounds.hi.x), v.y + offset(stream, slack)};
      b = {stream.uniform(bounds.lo.x, bounds.hi.x), a.y};
      break;
    default: {  // by 45 degrees past a corner, with an offset: through the touching corners of cells
      const double by = offset(stream, slack), length = stream.uniform(0.01, 0.5) * size.x;
      const double sign = stream.below(2) == 0 ? 1.0 : -1.0;
      a = {v.x - length + by, v.y - sign * length};
      b = {v.x + length + by, v.y + sign * length};
    }
  }
  return {clamped(a), clamped(b)};
}

}  // namespace

TEST_CASE("checkers decide the motions of a point in the plane exactly", "[certified][segments]") {
  for (const std::string& kind : HardWorld::kinds()) {
    Counts counts;
    constexpr std::size_t worlds = 20;
    const std::size_t each = segments(5'000) / worlds;
    for (std::size_t i = 0; i < worlds; ++i) {
      Stream stream(i, kind, "segments");
      Placement placement = random_placement(stream);
      placement.scale *= stream.uniform(0.7, 1.3);
      const auto scene = std::make_shared<const PlanarScene>(HardWorld::make(kind, stream, placement), Robot::point());
      const std::vector<Vec2> vertices = vertices_of(scene->world);
      if (vertices.empty()) continue;
      // Coarse and fine: exactness does not depend on it.
      const Comparison comparison(scene, (i % 2 == 0 ? 10.0 : 0.3) * placement.scale);
      const double slack = std::ldexp(scene->magnitude(), -43);
      for (std::size_t k = 0; k < each; ++k) {
        const auto [a, b] = grazing(stream, vertices, scene->world.bounds(), slack);
        comparison.compare(a, b, counts);
      }
    }
    report(kind, counts);
  }
}

namespace {

/// A point on or beside an obstacle's surface: a corner, a point of an edge, of a face, or of a round side.
Vec3 near_surface(Stream& stream, const Solid& solid) {
  static constexpr std::array stops = {-1.0, 0.0, 1.0};
  const auto one = [&stream] {
    return stream.below(2) == 0 ? stops[stream.below(stops.size())] : stream.uniform(-1.0, 1.0);
  };
  const double x = one(), y = one(), z = one(), angle = stream.uniform(0, 2 * std::numbers::pi);
  Vec3 p;
  if (const auto* sphere = std::get_if<Sphere>(&solid.shape)) {
    const double across = std::sqrt(1.0 - z * z);
    p = sphere->radius * Vec3{across * std::cos(angle), across * std::sin(angle), z};
  } else if (const auto* box = std::get_if<Cuboid>(&solid.shape)) {
    p = {0.5 * x * box->size.x, 0.5 * y * box->size.y, 0.5 * z * box->size.z};
  } else if (const auto* cylinder = std::get_if<Cylinder>(&solid.shape)) {
    p = {cylinder->radius * std::cos(angle), cylinder->radius * std::sin(angle), 0.5 * z * cylinder->length};
  } else if (const auto* capsule = std::get_if<Capsule>(&solid.shape)) {
    p = {capsule->radius * std::cos(angle), capsule->radius * std::sin(angle), 0.5 * z * capsule->length};
  } else {
    const Mesh& mesh = *std::get<std::shared_ptr<const Mesh>>(solid.shape);
    const Triangle& t = mesh.triangles()[stream.below(mesh.triangles().size())];
    const double share = stream.below(2) == 0 ? 0.0 : stream.uniform();
    p = (1.0 - share) * mesh.vertices()[t[0]] + share * mesh.vertices()[t[1]];
  }
  return solid.pose(p);
}

std::pair<Configuration, Configuration> grazing(Stream& stream, const World3& world, double slack) {
  const auto& [lo, hi] = world.bounds();
  const auto anywhere = [&] {
    const double x = stream.uniform(lo.x, hi.x), y = stream.uniform(lo.y, hi.y), z = stream.uniform(lo.z, hi.z);
    return Vec3{x, y, z};
  };
  const auto on_surface = [&] {
    return near_surface(stream, world.obstacles()[stream.below(world.obstacles().size())].solid);
  };
  Vec3 a = anywhere(), b = anywhere();
  const Vec3 v = on_surface();
  switch (stream.below(4)) {
    case 0: break;
    case 1: b = v + stream.uniform(0.05, 1.0) * (v - a); break;
    case 2: {
      const Vec3 w = on_surface();
      a = v + stream.uniform(0.05, 1.0) * (v - w);
      b = w + stream.uniform(0.05, 1.0) * (w - v);
      break;
    }
    default: {  // along an axis, beside the surface
      const double by = offset(stream, slack), also = offset(stream, slack);
      switch (stream.below(3)) {
        case 0:
          a = {a.x, v.y + by, v.z + also};
          b = {b.x, a.y, a.z};
          break;
        case 1:
          a = {v.x + by, a.y, v.z + also};
          b = {a.x, b.y, a.z};
          break;
        default:
          a = {v.x + by, v.y + also, a.z};
          b = {a.x, a.y, b.z};
          break;
      }
    }
  }
  const auto clamped = [&lo = lo, &hi = hi](const Vec3& p) {
    return Configuration{std::clamp(p.x, lo.x, hi.x), std::clamp(p.y, lo.y, hi.y), std::clamp(p.z, lo.z, hi.z)};
  };
  return {clamped(a), clamped(b)};
}

}  // namespace

TEST_CASE("checkers decide the motions of a point in space exactly", "[certified][segments]") {
  for (const std::string& kind : HardWorld3::kinds()) {
    Counts counts;
    constexpr std::size_t worlds = 20;
    const std::size_t each = segments(3'000) / worlds;
    for (std::size_t i = 0; i < worlds; ++i) {
      Stream stream(i, kind, "segments");
      Placement placement = random_placement(stream);
      placement.scale *= stream.uniform(0.7, 1.3);
      const auto scene =
          std::make_shared<const SpatialScene>(HardWorld3::make(kind, stream, placement), Robot3::point());
      const Comparison comparison(scene, (i % 2 == 0 ? 10.0 : 0.5) * placement.scale);
      const double slack = std::ldexp(scene->magnitude(), -43);
      for (std::size_t k = 0; k < each; ++k) {
        const auto [a, b] = grazing(stream, scene->world, slack);
        comparison.compare(a, b, counts);
      }
    }
    report(kind, counts);
  }
}

TEST_CASE("the motion of a point across the end of a periodic axis is two segments", "[certified][segments]") {
  const auto valid = [](const std::string& backend, double wall) {
    const auto scene = std::make_shared<const PlanarScene>(
        World({{0, 0}, {10, 10}}, {{"wall", Box2{{wall, 0}, {wall + 1e-3, 10}}}}), Robot::point());
    const Space space("cylinder",
                      {{.name = "x", .lo = 0, .hi = 10, .periodic = true}, {.name = "y", .lo = 0, .hi = 10}});
    return make_checker(backend, scene, space, 0.3)->motion(Configuration{9.3, 4}, Configuration{0.6, 5}).valid;
  };
  for (const char* const backend : {"planar", "fcl"}) {
    INFO(backend);
    CHECK_FALSE(valid(backend, 9.77));
    CHECK_FALSE(valid(backend, 0.33));
    CHECK(valid(backend, 0.7));
    CHECK(valid(backend, 5.0));
    CHECK(valid(backend, 9.2));
  }
}
