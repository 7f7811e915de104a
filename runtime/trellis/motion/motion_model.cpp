// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/motion/motion_model.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/motion/small_state.hpp>

namespace trellis {

MotionModel::MotionModel(std::string name, std::string text, std::size_t configuration_dimension,
                         std::vector<Axis> velocities, std::vector<ControlAxis> controls, double dt)
    : name_(std::move(name)),
      text_(std::move(text)),
      configuration_dimension_(configuration_dimension),
      velocities_(std::move(velocities)),
      controls_(std::move(controls)),
      dt_(dt) {}

bool MotionModel::allows(View u) const {
  if (u.size() != controls_.size()) return false;
  for (std::size_t j = 0; j < controls_.size(); ++j) {
    if (!(u[j] >= controls_[j].lo && u[j] <= controls_[j].hi)) return false;
  }
  return true;
}

void MotionModel::clamp(MutableView u) const {
  for (std::size_t j = 0; j < controls_.size(); ++j) u[j] = std::clamp(u[j], controls_[j].lo, controls_[j].hi);
}

void MotionModel::sample_control(Stream& stream, MutableView u) const {
  for (std::size_t j = 0; j < controls_.size(); ++j) u[j] = stream.uniform(controls_[j].lo, controls_[j].hi);
}

void MotionModel::step(const Space& space, View x, View u, MutableView out) const {
  SmallState own;
  const MutableView rate = own.of(dimension());
  derivative(x, u, rate);
  for (std::size_t j = 0; j < dimension(); ++j) out[j] = x[j] + dt_ * rate[j];
  space.normalise(out);
}

double Trajectory::duration() const {
  return dt * static_cast<double>(std::accumulate(steps.begin(), steps.end(), std::uint64_t{0}));
}

Configurations replay(const MotionModel& model, const Space& space, View start, const Trajectory& trajectory) {
  Configurations states(space.dimension());
  states.push(start);
  Configuration x(start.begin(), start.end());
  for (std::size_t i = 0; i < trajectory.controls.size(); ++i) {
    const View u = trajectory.controls[i];
    if (!model.allows(u)) {
      throw Error(fmt::format("control {} of the trajectory ({:g}) is out of the bounds of {}", i + 1,
                              fmt::join(u, ", "), model.text()));
    }
    for (std::uint32_t k = 0; k < trajectory.steps[i]; ++k) {
      model.step(space, x, u, x);
      states.push(x);
    }
  }
  return states;
}

Space state_space(const Space& configurations, const MotionModel& model) {
  if (configurations.dimension() != model.configuration_dimension()) {
    std::vector<std::string> names;
    names.reserve(configurations.dimension());
    for (const Axis& axis : configurations.axes()) names.push_back(axis.name);
    throw Error(fmt::format("the motion model {} moves a robot of {} coordinates ({}); this one has {} ({})",
                            model.name(), model.configuration_dimension(),
                            model.configuration_dimension() == 3 ? "x, y, theta" : "x, y, theta, theta of the trailer",
                            configurations.dimension(), fmt::join(names, ", ")));
  }
  if (model.velocities().empty()) return configurations;
  std::vector<Axis> axes = configurations.axes();
  axes.insert(axes.end(), model.velocities().begin(), model.velocities().end());
  return {fmt::format("{} x R^{}", configurations.name(), model.velocities().size()), std::move(axes)};
}

}  // namespace trellis
