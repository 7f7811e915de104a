// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/free_distance.hpp>

#include <algorithm>

#include <trellis/scene/spatial/distance_field.hpp>

namespace trellis {

FreeDistance::FreeDistance(const World3& world)
    : obstacles_(world.distances()->distance()), bounds_(world.bounds()), bounded_(world.contain() == Contain::robot) {}

double FreeDistance::operator()(const Vec3& p) const {
  const double distance = (*obstacles_)(p);
  return bounded_ ? std::min(distance, side(p).distance) : distance;
}

FreeDistance::Nearest FreeDistance::nearest(const Vec3& p) const {
  const NearestObstacle obstacle = obstacles_->nearest(p);
  const Nearest found{obstacle.distance, obstacle.point};
  if (!bounded_) return found;
  const Nearest of_side = side(p);
  return of_side.distance < found.distance ? of_side : found;
}

FreeDistance::Nearest FreeDistance::side(const Vec3& p) const {
  Nearest best{p.x - bounds_.lo.x, {bounds_.lo.x, p.y, p.z}};
  const auto offer = [&](double distance, const Vec3& point) {
    if (distance < best.distance) best = {distance, point};
  };
  offer(bounds_.hi.x - p.x, {bounds_.hi.x, p.y, p.z});
  offer(p.y - bounds_.lo.y, {p.x, bounds_.lo.y, p.z});
  offer(bounds_.hi.y - p.y, {p.x, bounds_.hi.y, p.z});
  offer(p.z - bounds_.lo.z, {p.x, p.y, bounds_.lo.z});
  offer(bounds_.hi.z - p.z, {p.x, p.y, bounds_.hi.z});
  return best;
}

}  // namespace trellis
