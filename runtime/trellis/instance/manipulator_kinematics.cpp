// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/manipulator_kinematics.hpp>

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/instance/search_cost.hpp>

namespace trellis {

namespace {

/// Of the rows of a step's equations: 3 for a point, 6 for a frame. Bounded sizes need no allocation.
using RowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

}  // namespace

struct ManipulatorKinematics::Scratch {
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;
  Eigen::VectorXd change;       ///< of a step: metres of the metric, by coordinate
  std::vector<char> fixed;      ///< coordinates that a step would take beyond their limits
  std::vector<double> weights;  ///< metres of the metric per unit of a coordinate
  std::vector<double> lo;
  std::vector<double> hi;       ///< at most lo where the coordinate has no limits
  std::vector<char> rotations;  ///< whether the coordinate is the first one of a quaternion
};

ManipulatorKinematics::ManipulatorKinematics(const SphereModel& robot, const Space& space, const PointOnBody& point)
    : robot_(robot), space_(space), point_(point), scratch_(std::make_unique<Scratch>()) {
  for (std::size_t at = point.body; at != 0; at = robot.robot().bodies()[at].parent) chain_.push_back(at);
  std::reverse(chain_.begin(), chain_.end());
  frames_.resize(chain_.size());
  const std::size_t columns = robot.robot().dimension();
  scratch_->jacobian.resize(6, static_cast<Eigen::Index>(columns));
  scratch_->change.resize(static_cast<Eigen::Index>(columns));
  scratch_->fixed.resize(columns);
  const std::vector<Axis> axes = space.coordinates();
  for (std::size_t j = 0; j < columns; ++j) {
    scratch_->weights.push_back(axes[j].weight);
    scratch_->lo.push_back(axes[j].periodic ? 0.0 : axes[j].lo);
    scratch_->hi.push_back(axes[j].periodic ? 0.0 : axes[j].hi);
  }
  scratch_->rotations.assign(axes.size(), 0);
  for (const Factor& factor : space.factors()) {
    if (factor.kind != Factor::Kind::rotation) continue;
    scratch_->rotations[factor.column] = 1;
    for (std::size_t k = 0; k < factor.width(); ++k)
      scratch_->lo[factor.column + k] = scratch_->hi[factor.column + k] = 0.0;
  }
}

ManipulatorKinematics::~ManipulatorKinematics() = default;

void ManipulatorKinematics::place(View q) {
  Pose3 pose = robot_.base();
  for (std::size_t i = 0; i < chain_.size(); ++i) {
    pose = pose * robot_.robot().joint_pose(chain_[i], q);
    frames_[i] = pose;
  }
  end_ = {pose(point_.point), pose.orientation};
}

Vec3 ManipulatorKinematics::position(View q) {
  place(q);
  return end_.position;
}

Pose3 ManipulatorKinematics::frame(View q) {
  place(q);
  return end_;
}

bool ManipulatorKinematics::bring(MutableView q, const Vec3& target, double near) {
  return solve(q, {target, {}}, near, 0.0, false);
}

bool ManipulatorKinematics::bring(MutableView q, const Pose3& target, double near, double turn) {
  return solve(q, target, near, turn, true);
}

bool ManipulatorKinematics::solve(MutableView q, const Pose3& target, double near, double turn, bool oriented) {
  constexpr int most_steps = 100;
  constexpr int patience = 10;      // steps without progress
  constexpr double longest = 0.3;   // metres of one step
  constexpr double lever = 0.3;     // metres per radian: how much a turn counts beside a distance
  constexpr double damping = 1e-4;  // of the largest diagonal entry
  const Eigen::Index rows = oriented ? 6 : 3;
  auto& jacobian = scratch_->jacobian;
  const std::size_t columns = scratch_->weights.size();
  double least = std::numeric_limits<double>::infinity();
  int idle = 0;
  auto& fixed = scratch_->fixed;
  auto& change = scratch_->change;
  RowMatrix normal(rows, rows);
  Eigen::LDLT<RowMatrix> factors(rows);
  RowVector force(rows);
  for (int step = 0; step < most_steps; ++step) {
    announce_work(search_cost::kinematics);
    ++steps_;
    place(q);
    Vec3 error = target.position - end_.position;
    const double distance = norm(error);
    Vec3 spin;
    if (oriented) spin = rotation_vector(target.orientation * end_.orientation.inverse());
    const double angle = norm(spin);
    if (distance <= near && (!oriented || angle <= turn)) return true;
    const double off = distance + lever * angle;
    idle = off < 0.95 * least ? 0 : idle + 1;
    least = std::min(least, off);
    if (idle > patience) return false;
    if (distance > longest) error = longest / distance * error;
    if (lever * angle > longest) spin = longest / (lever * angle) * spin;
    jacobian.setZero();
    for (std::size_t i = 0; i < chain_.size(); ++i) {
      const Manipulator::Body& body = robot_.robot().bodies()[chain_[i]];
      const auto add = [&](std::size_t column, const Vec3& moves, const Vec3& turns) {
        const double scale = body.multiplier / scratch_->weights[column];
        const auto c = static_cast<Eigen::Index>(column);
        jacobian.col(c) += scale * Eigen::Matrix<double, 6, 1>{moves.x,         moves.y,         moves.z,
                                                               lever * turns.x, lever * turns.y, lever * turns.z};
      };
      if (body.kind == Joint::Kind::planar) {
        // The directions in which the joint slides are those of its frame before it turns.
        const Pose3 before = (i == 0 ? robot_.base() : frames_[i - 1]) * body.origin;
        const Vec3 axis = before.orientation(body.axis);
        const Vec3 u = before.orientation(across(body.axis).first);
        const Vec3 v = before.orientation(across(body.axis).second);
        add(body.column, u, {});
        add(body.column + 1, v, {});
        add(body.column + 2, cross(axis, end_.position - frames_[i].position), axis);
        continue;
      }
      if (body.is_root()) {
        const Pose3 before = (i == 0 ? robot_.base() : frames_[i - 1]) * body.origin;
        const std::array<Vec3, 3> units = {Vec3{1.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0}, Vec3{0.0, 0.0, 1.0}};
        if (body.kind == Joint::Kind::translation_2) {
          const auto [u, v] = across(body.axis);
          add(body.column, before.orientation(u), {});
          add(body.column + 1, before.orientation(v), {});
          continue;
        }
        for (std::size_t k = 0; k < units.size(); ++k) {
          const Vec3 axis = before.orientation(units[k]);
          add(body.column + k, axis, {});
          // A quaternion turns by a rotation vector in the frame before, in the columns of its first three coordinates.
          if (body.kind != Joint::Kind::floating) continue;
          add(body.column + 3 + k, cross(axis, end_.position - frames_[i].position), axis);
        }
        continue;
      }
      const Vec3 axis = frames_[i].orientation(body.axis);
      if (body.kind == Joint::Kind::prismatic) {
        add(body.column, axis, {});
      } else {
        add(body.column, cross(axis, end_.position - frames_[i].position), axis);
      }
    }
    const Eigen::Matrix<double, 6, 1> wanted{error.x, error.y, error.z, lever * spin.x, lever * spin.y, lever * spin.z};
    std::fill(fixed.begin(), fixed.end(), 0);
    // Coordinates that a step would take beyond their limits stay, and the others make the step.
    for (int pass = 0; pass < 3; ++pass) {
      normal.noalias() = jacobian.topRows(rows) * jacobian.topRows(rows).transpose();
      const double trace = normal.trace();
      if (!(trace > 0.0)) return false;
      normal.diagonal().array() += damping * trace;
      factors.compute(normal);
      force = factors.solve(wanted.head(rows));
      change.noalias() = jacobian.topRows(rows).transpose() * force;
      bool beyond = false;
      for (std::size_t j = 0; j < columns; ++j) {
        if (!(scratch_->lo[j] < scratch_->hi[j]) || fixed[j] != 0) continue;
        const double to = q[j] + change[static_cast<Eigen::Index>(j)] / scratch_->weights[j];
        const bool stuck =
            (to < scratch_->lo[j] && q[j] <= scratch_->lo[j]) || (to > scratch_->hi[j] && q[j] >= scratch_->hi[j]);
        if (!stuck) continue;
        fixed[j] = 1;
        jacobian.col(static_cast<Eigen::Index>(j)).setZero();
        beyond = true;
      }
      if (!beyond) break;
    }
    for (std::size_t j = 0; j < columns; ++j) {
      const auto by = [&](std::size_t k) { return change[static_cast<Eigen::Index>(k)] / scratch_->weights[k]; };
      if (scratch_->rotations[j] != 0) {
        const Quaternion turned =
            rotation_of({by(j), by(j + 1), by(j + 2)}) * Quaternion{q[j], q[j + 1], q[j + 2], q[j + 3]};
        q[j] = turned.x, q[j + 1] = turned.y, q[j + 2] = turned.z, q[j + 3] = turned.w;
        j += 3;
        continue;
      }
      q[j] += by(j);
      if (scratch_->lo[j] < scratch_->hi[j]) q[j] = std::clamp(q[j], scratch_->lo[j], scratch_->hi[j]);
    }
    space_.normalise(q);
  }
  return false;
}

}  // namespace trellis
