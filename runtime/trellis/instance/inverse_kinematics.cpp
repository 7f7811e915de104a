// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/inverse_kinematics.hpp>

#include <algorithm>
#include <limits>

namespace trellis {

InverseKinematics::InverseKinematics(const Robot& robot, const Space& space, std::size_t body, Vec2 point)
    : robot_(robot),
      space_(space),
      body_(body),
      point_(point),
      poses_(robot.bodies().size()),
      columns_(space.dimension()) {}

bool InverseKinematics::bring(MutableView q, Vec2 target, double near) {
  constexpr int most_steps = 200;
  constexpr double step = 1e-6;  // of the finite differences
  constexpr double longest = 1.0;
  for (int i = 0; i < most_steps; ++i) {
    const Vec2 at = point_at(q);
    Vec2 displacement = target - at;
    const double distance = norm(displacement);
    if (distance <= near) return true;
    if (distance > longest) displacement = longest / distance * displacement;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      const double before = q[j];
      q[j] = before + step;
      // Per metre of the metric, so that the axes share the motion in proportion to their weights.
      columns_[j] = 1.0 / (step * space_.axes()[j].weight) * (point_at(q) - at);
      q[j] = before;
      xx += columns_[j].x * columns_[j].x;
      xy += columns_[j].x * columns_[j].y;
      yy += columns_[j].y * columns_[j].y;
    }
    const double damping = 1e-4 * (xx + yy) + std::numeric_limits<double>::min();
    xx += damping;
    yy += damping;
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 0.0)) return false;
    const Vec2 force{(yy * displacement.x - xy * displacement.y) / determinant,
                     (xx * displacement.y - xy * displacement.x) / determinant};
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      const Axis& axis = space_.axes()[j];
      q[j] += dot(columns_[j], force) / axis.weight;
      if (!axis.periodic) q[j] = std::clamp(q[j], axis.lo, axis.hi);
    }
    space_.normalise(q);
  }
  return false;
}

Vec2 InverseKinematics::point_at(View q) {
  robot_.place(q, poses_);
  return poses_[body_](point_);
}

}  // namespace trellis
