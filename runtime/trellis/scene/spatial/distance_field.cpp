// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/distance_field.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <utility>

#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double longest_side(const Vec3& extent) { return std::max({extent.x, extent.y, extent.z}); }

std::array<std::size_t, 3> counts_of(const Vec3& extent, double spacing) {
  const auto count = [&](double side) { return static_cast<std::size_t>(std::ceil(side / spacing)) + 1; };
  return {count(extent.x), count(extent.y), count(extent.z)};
}

double size_of(const std::array<std::size_t, 3>& counts) {
  return static_cast<double>(counts[0]) * static_cast<double>(counts[1]) * static_cast<double>(counts[2]);
}

double distance_from(const Box3& box, const Vec3& p) {
  return norm({std::max({box.lo.x - p.x, p.x - box.hi.x, 0.0}), std::max({box.lo.y - p.y, p.y - box.hi.y, 0.0}),
               std::max({box.lo.z - p.z, p.z - box.hi.z, 0.0})});
}

}  // namespace

void DistanceField::Release::operator()(float* values) const { std::free(values); }

DistanceField::DistanceField(std::shared_ptr<const ObstacleDistance> distance, const Box3& region, double spacing)
    : distance_(std::move(distance)), obstacles_(distance_->bounds()) {
  const Vec3 extent = region.hi - region.lo;
  // No side has more voxels than that, so that the counts below do not overflow.
  spacing_ = std::max(spacing, longest_side(extent) / static_cast<double>(most_voxels));
  while (size_of(counts_of(extent, spacing_)) > static_cast<double>(most_voxels)) spacing_ *= 1.05;
  counts_ = counts_of(extent, spacing_);
  per_metre_ = 1.0 / spacing_;
  const auto beyond = [&](std::size_t count, double side) {
    return 0.5 * (spacing_ * static_cast<double>(count - 1) - side);
  };
  origin_ = region.lo - Vec3{beyond(counts_[0], extent.x), beyond(counts_[1], extent.y), beyond(counts_[2], extent.z)};
  const auto most = [](const Vec3& v) { return longest_side({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
  rounding_ = std::ldexp(most(region.lo) + most(region.hi), -40);
  // The system gives zeros without touching them: a page of memory is taken when a voxel on it gets its value.
  values_.reset(static_cast<float*>(std::calloc(size(), sizeof(float))));
  if (values_ == nullptr) throw std::bad_alloc();
}

double DistanceField::compute(std::size_t index) const {
  // Infinity has no bounds that are numbers.
  constexpr double most = std::numeric_limits<float>::max();
  auto value = static_cast<float>(std::min((*distance_)(centre(index)), most));
  if (value == 0.0F) value = std::numeric_limits<float>::denorm_min();
  // Threads that compute the same value at the same time store the same bits.
  std::atomic_ref<float>(values_.get()[index]).store(value, std::memory_order_relaxed);
  return value;
}

void DistanceField::fill() const {
  for (std::size_t i = 0; i < size(); ++i) static_cast<void>(value(i));
}

DistanceField::Bounds DistanceField::beyond(const Vec3& p, double here, double away, double slack) const {
  return {std::max(here - away, distance_from(obstacles_, p)) - slack, here + away + slack};
}

Vec3 DistanceField::gradient(const Vec3& p) const {
  const NearestObstacle found = distance_->nearest(p);
  const Vec3 away = found.distance > 0.0 ? p - found.point : found.point - p;
  const double length = norm(away);
  return length > 0.0 && found.distance != infinity ? (1.0 / length) * away : Vec3{};
}

DistanceFields::DistanceFields(const World3& world) {
  std::vector<Solid> solids;
  solids.reserve(world.obstacles().size());
  for (const Obstacle3& obstacle : world.obstacles()) solids.push_back(obstacle.solid);
  distance_ = std::make_shared<const ObstacleDistance>(solids, world.surface());

  // Robots stick out of the bounds by a length that the world does not know. Where the field ends, its bounds only
  // become less exact.
  constexpr double margin = 0.1;
  const double beyond = margin * norm(world.bounds().hi - world.bounds().lo);
  Box3 region{world.bounds().lo - Vec3{beyond, beyond, beyond}, world.bounds().hi + Vec3{beyond, beyond, beyond}};
  if (!solids.empty()) {
    const Box3 obstacles = distance_->bounds();
    const Box3 both{greatest_of(region.lo, obstacles.lo), least_of(region.hi, obstacles.hi)};
    if (both.lo.x <= both.hi.x && both.lo.y <= both.hi.y && both.lo.z <= both.hi.z) region = both;
  }
  const Vec3 extent = region.hi - region.lo;
  const double longest = std::max(longest_side(extent), std::numeric_limits<double>::min());

  constexpr double most_at_finest = 250'000;
  constexpr double most_along_a_side = 1024;
  constexpr double least_along_a_side = 8;
  double spacing = longest / most_along_a_side;
  while (size_of(counts_of(extent, spacing)) > most_at_finest) spacing *= 1.02;
  do {
    levels_.emplace_back(distance_, region, spacing);
    spacing *= 2.0;
  } while (spacing * least_along_a_side <= longest);
}

std::size_t DistanceFields::level_of(double spacing) const {
  std::size_t level = 0;
  while (level + 1 < levels_.size() && levels_[level + 1].spacing() <= spacing) ++level;
  return level;
}

}  // namespace trellis
