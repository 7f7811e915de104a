// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/motion/team_model.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/motion/small_state.hpp>

namespace trellis {

namespace {

using Models = std::vector<std::shared_ptr<const MotionModel>>;

/// The words of all models, or of the one that all robots have.
template <class F>
std::string joined(const Models& models, const F& text) {
  std::vector<std::string> texts;
  texts.reserve(models.size());
  for (const auto& model : models) texts.push_back(text(*model));
  const bool same = std::all_of(texts.begin(), texts.end(), [&](const std::string& one) { return one == texts[0]; });
  return same ? texts.front() : fmt::format("{}", fmt::join(texts, ", "));
}

std::size_t configurations_of(const Models& models) {
  std::size_t sum = 0;
  for (const auto& model : models) sum += model->configuration_dimension();
  return sum;
}

std::vector<Axis> velocities_of(const Models& models) {
  std::vector<Axis> all;
  for (std::size_t i = 0; i < models.size(); ++i) {
    for (Axis axis : models[i]->velocities()) {
      if (i > 0) axis.name += std::to_string(i + 1);
      all.push_back(std::move(axis));
    }
  }
  return all;
}

std::vector<ControlAxis> controls_of(const Models& models) {
  std::vector<ControlAxis> all;
  for (std::size_t i = 0; i < models.size(); ++i) {
    for (ControlAxis axis : models[i]->controls()) {
      if (i > 0) axis.name += std::to_string(i + 1);
      all.push_back(std::move(axis));
    }
  }
  return all;
}

}  // namespace

TeamModel::TeamModel(const Models& models, const std::vector<std::vector<std::size_t>>& axes)
    : MotionModel(joined(models, [](const MotionModel& model) { return model.name(); }),
                  joined(models, [](const MotionModel& model) { return model.text(); }), configurations_of(models),
                  velocities_of(models), controls_of(models), models.front()->dt()) {
  std::size_t velocity = configuration_dimension();
  std::size_t control = 0;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const MotionModel& model = *models[i];
    if (model.configuration_dimension() != axes.at(i).size()) {
      throw Error(fmt::format("the motion model {} moves a robot of {} coordinates, and robot {} of the team has {}",
                              model.name(), model.configuration_dimension(), i + 1, axes[i].size()));
    }
    if (model.dt() != dt()) {
      throw Error(
          fmt::format("the motion models of a team take steps of the same duration: that of robot 1 has dt = {:g} s, "
                      "that of robot {} has {:g} s",
                      dt(), i + 1, model.dt()));
    }
    Part part{models[i], axes[i], control};
    for (std::size_t k = 0; k < model.velocities().size(); ++k) part.columns.push_back(velocity++);
    control += model.controls().size();
    step_work_ += model.step_work();
    parts_.push_back(std::move(part));
  }
}

void TeamModel::derivative(View x, View u, MutableView rate) const {
  SmallState own, change;
  for (const Part& part : parts_) {
    const std::size_t n = part.columns.size();
    const MutableView state = own.of(n);
    const MutableView its_rate = change.of(n);
    for (std::size_t j = 0; j < n; ++j) state[j] = x[part.columns[j]];
    part.model->derivative(state, part.own(u), its_rate);
    for (std::size_t j = 0; j < n; ++j) rate[part.columns[j]] = its_rate[j];
  }
}

bool TeamModel::admits(View x) const {
  SmallState own;
  return std::all_of(parts_.begin(), parts_.end(), [&](const Part& part) {
    const MutableView state = own.of(part.columns.size());
    for (std::size_t j = 0; j < state.size(); ++j) state[j] = x[part.columns[j]];
    return part.model->admits(state);
  });
}

PathClock::PathClock(double duration, double dt)
    : MotionModel("path", "path", 1, {}, {{"advance", 0.0, 1.0}}, dt), duration_(duration) {}

void PathClock::derivative(View x, View u, MutableView rate) const {
  constexpr double on = 0.5;
  rate[0] = u[0] >= on && x[0] + 0.5 * dt() < duration_ ? 1.0 : 0.0;
}

std::optional<Trajectory> PathClock::to(double from, double until) const {
  const double steps = std::round((until - from) / dt());
  if (steps < 0.0) return std::nullopt;
  Trajectory trajectory{Configurations(1), {}, dt()};
  if (steps == 0.0) return trajectory;
  trajectory.controls.push(Configuration{1.0});
  trajectory.steps.push_back(static_cast<std::uint32_t>(steps));
  return trajectory;
}

const TeamModel* team_model(const MotionModel& model) { return dynamic_cast<const TeamModel*>(&model); }

bool can_wait(const MotionModel& model) {
  // With velocities in the state a control of 0 keeps the speed.
  return model.velocities().empty() &&
         std::all_of(model.controls().begin(), model.controls().end(),
                     [](const ControlAxis& control) { return control.lo <= 0.0 && control.hi >= 0.0; });
}

}  // namespace trellis
