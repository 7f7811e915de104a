// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/link_projection.hpp>
#include <trellis/instance/search_cost.hpp>

#include <algorithm>
#include <limits>
#include <vector>

namespace trellis {

LinkProjection::LinkProjection(const Instance& parent, const PointOnBody& point)
    : TipProjection(parent.space),
      scene_(parent.scene),
      robot_(scene_->manipulator()->robot),
      point_(point),
      lift_work_(parent.lift_work.shared()) {
  const World3& world = scene_->manipulator()->world;
  std::vector<std::size_t> chain;
  for (std::size_t at = point.body; at != 0; at = robot_.robot().bodies()[at].parent) chain.push_back(at);
  const auto& bodies = robot_.robot().bodies();
  const Manipulator::Body& first = bodies[chain.back()];
  centre_ = robot_.base()(first.origin.position);
  reach_ = norm(point.point);
  for (const std::size_t at : chain) {
    reach_ += robot_.robot().extension(at);
    if (at != chain.back()) reach_ += norm(bodies[at].origin.position);
  }
  if (first.is_root()) reach_ = std::numeric_limits<double>::infinity();
  const auto& [lo, hi] = world.bounds();
  // A world's bounds limit the point only where they contain the robot.
  const bool free = world.contain() == Contain::none && std::isfinite(reach_);
  const auto range = [&](double centre, double from, double to) {
    const double a = free ? centre - reach_ : std::max(from, centre - reach_);
    const double b = free ? centre + reach_ : std::min(to, centre + reach_);
    return std::pair(a, std::max(b, a + 1e-6 * robot_.bounding_radius()));
  };
  space_ = Space::euclidean({range(centre_.x, lo.x, hi.x), range(centre_.y, lo.y, hi.y), range(centre_.z, lo.z, hi.z)});
  near_ = 1e-4 * robot_.bounding_radius();
  point_scene_ = scene_->of_point();
}

void LinkProjection::project(View q, MutableView s) const {
  const Vec3 p = robot_.position(point_, q);
  s[0] = p.x;
  s[1] = p.y;
  s[2] = p.z;
}

bool LinkProjection::reaches(View s) const { return norm(Vec3{s[0], s[1], s[2]} - centre_) <= reach_; }

bool LinkProjection::follow(View s, MutableView q) const {
  ManipulatorKinematics kinematics(robot_, parent(), point_);
  const bool found = kinematics.bring(q, Vec3{s[0], s[1], s[2]}, near_);
  count(kinematics);
  return found;
}

void LinkProjection::count(const ManipulatorKinematics& kinematics) const {
  *lift_work_ += search_cost::kinematics * static_cast<double>(kinematics.steps());
}

void LinkProjection::lift(View s, Stream& stream, MutableView q) const {
  constexpr int most_starts = 8;
  ManipulatorKinematics kinematics(robot_, parent(), point_);
  for (int i = 0; i < most_starts; ++i) {
    parent().sample_uniform(stream, q);
    if (reaches(s) && kinematics.bring(q, Vec3{s[0], s[1], s[2]}, near_)) return count(kinematics);
  }
  count(kinematics);
  parent().sample_uniform(stream, q);
}

double LinkProjection::log_fibre_density(View q) const {
  static_cast<void>(q);
  return -std::numeric_limits<double>::infinity();
}

}  // namespace trellis
