// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/point_cloud.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <mutex>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/scene/spatial/box_tree.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

/// Distances of boxes are lowered by this share before they are compared, so that rounding leaves no point out.
constexpr double rounding = 1e-12;

double squared_distance(const Box3& box, const Vec3& p) {
  const double x = std::max({box.lo.x - p.x, p.x - box.hi.x, 0.0});
  const double y = std::max({box.lo.y - p.y, p.y - box.hi.y, 0.0});
  const double z = std::max({box.lo.z - p.z, p.z - box.hi.z, 0.0});
  return x * x + y * y + z * z;
}

struct HashOfPoint {
  std::size_t operator()(const Vec3& p) const {
    std::uint64_t hash = 0x9e3779b97f4a7c15;
    // 0 and -0 are the same coordinate.
    for (const double x : {p.x + 0.0, p.y + 0.0, p.z + 0.0}) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0xff51afd7ed558ccd;
      hash ^= hash >> 32U;
    }
    return hash;
  }
};

void check_radius(double radius, const std::string& what) {
  if (radius > 0.0 && radius <= most_distant) return;
  throw Error(fmt::format("{}: the radius of its points must be greater than 0 and at most {:g} m, got {:g}", what,
                          most_distant, radius));
}

}  // namespace

/// A tree over the points, made when it is first used.
struct PointCloud::Index {
  std::once_flag made;
  BoxTree tree;
  std::vector<Vec3> points;  ///< in the tree's order

  void make(const std::vector<Vec3>& of) {
    std::call_once(made, [&] {
      std::vector<Box3> boxes;
      boxes.reserve(of.size());
      for (const Vec3& p : of) boxes.push_back({p, p});
      tree = BoxTree(boxes);
      points.reserve(of.size());
      for (const std::uint32_t i : tree.order()) points.push_back(of[i]);
    });
  }
};

PointCloud::PointCloud(std::vector<Vec3> points, double radius, const std::string& what)
    : points_(std::move(points)), radius_(radius), index_(std::make_shared<Index>()) {
  check_radius(radius, what);
  if (points_.empty()) throw Error(fmt::format("{}: it has no points", what));
  if (points_.size() > most_points) {
    throw Error(fmt::format("{}: it has {} points, and a cloud at most {}", what, points_.size(), most_points));
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec3& p = points_[i];
    if (in_range(p)) continue;
    throw Error(fmt::format("{}: point {} must lie within {:g} m of 0 in x, y and z, got ({}, {}, {})", what, i + 1,
                            most_distant, p.x, p.y, p.z));
  }
  std::unordered_set<Vec3, HashOfPoint> known;  // only looked up, so its order does not matter
  known.reserve(points_.size());
  std::erase_if(points_, [&](const Vec3& p) { return !known.insert(p).second; });
  add_bounds_and_hash();
}

void PointCloud::add_bounds_and_hash() {
  const Vec3 margin{radius_, radius_, radius_};
  const Box3 box = bounds_of(points_);
  bounds_ = {box.lo - margin, box.hi + margin};
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const std::array<std::uint64_t, 2> parts{
      stable_hash({reinterpret_cast<const char*>(points_.data()), points_.size() * sizeof(Vec3)}),
      std::bit_cast<std::uint64_t>(radius_)};
  hash_ = stable_hash({reinterpret_cast<const char*>(parts.data()), sizeof(parts)});
}

PointCloud PointCloud::thinned(double spacing) const {
  // Points in one cube are no farther apart than its diagonal. Below that share of the extent all cubes have one point.
  const double extent =
      std::max({bounds_.hi.x - bounds_.lo.x, bounds_.hi.y - bounds_.lo.y, bounds_.hi.z - bounds_.lo.z});
  constexpr double finest = 1e-6;
  if (!(spacing > finest * extent)) return *this;
  const double cell = spacing / std::sqrt(3.0) * (1.0 - rounding);
  std::unordered_map<std::uint64_t, std::size_t> kept;  // only looked up, so its order does not matter
  PointCloud made;
  double farthest = 0.0;
  for (const Vec3& p : points_) {
    const auto along = [&](double x, double lo) { return static_cast<std::uint64_t>((x - lo) / cell); };
    const std::uint64_t key =
        along(p.x, bounds_.lo.x) << 42U | along(p.y, bounds_.lo.y) << 21U | along(p.z, bounds_.lo.z);
    const auto [place, added] = kept.try_emplace(key, made.points_.size());
    if (added) {
      made.points_.push_back(p);
    } else {
      farthest = std::max(farthest, norm(p - made.points_[place->second]));
    }
  }
  made.radius_ = (radius_ + farthest) * (farthest > 0.0 ? 1.0 + rounding : 1.0);
  made.index_ = std::make_shared<Index>();
  made.add_bounds_and_hash();
  return made;
}

PointCloud PointCloud::scaled(double factor) const {
  std::vector<Vec3> points = points_;
  for (Vec3& p : points) p = factor * p;
  return {std::move(points), factor * radius_, "scaled points"};
}

PointCloud PointCloud::with_radius(double radius) const {
  check_radius(radius, "points");
  PointCloud made = *this;
  made.radius_ = radius;
  made.add_bounds_and_hash();
  return made;
}

PointCloud::Nearest PointCloud::nearest(const Vec3& p, double at_most) const {
  index_->make(points_);
  Nearest found{at_most, points_.size()};
  double most = at_most * at_most;
  std::uint32_t best = 0;
  bool any = false;
  index_->tree.nearest(
      most, [&](const Box3& box) { return (1.0 - rounding) * squared_distance(box, p); },
      [&](std::uint32_t rank) {
        const Vec3 from = p - index_->points[rank];
        const double squared = dot(from, from);
        if (!(squared < most)) return;
        most = squared;
        best = rank;
        any = true;
      });
  if (any) found = {std::sqrt(most), index_->tree.order()[best]};
  return found;
}

void PointCloud::each_near(const Box3& box, const std::function<bool(std::size_t)>& visit) const {
  index_->make(points_);
  bool more = true;
  index_->tree.each(
      [&](const Box3& other) {
        return more && other.lo.x <= box.hi.x && box.lo.x <= other.hi.x && other.lo.y <= box.hi.y &&
               box.lo.y <= other.hi.y && other.lo.z <= box.hi.z && box.lo.z <= other.hi.z;
      },
      [&](std::uint32_t i) { more = more && visit(i); });
}

}  // namespace trellis
