// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/base/configurations.hpp>
#include <trellis/base/random.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// One coordinate of a motion model's control.
struct ControlAxis {
  std::string name;  ///< "speed", "steering", ...
  double lo = 0.0;
  double hi = 0.0;
};

/// How a robot that cannot move straight to any configuration moves: dx/dt = f(x, u), in steps of explicit Euler. A
/// state x is a configuration (x, y, theta, perhaps theta of a trailer) followed by velocities. Immutable.
class MotionModel {
 public:
  MotionModel(const MotionModel&) = delete;
  MotionModel& operator=(const MotionModel&) = delete;
  virtual ~MotionModel() = default;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// As a script would write it: "unicycle1 { max_speed = 0.3 }".
  [[nodiscard]] const std::string& text() const { return text_; }
  /// The coordinates of a configuration, which come first in a state.
  [[nodiscard]] std::size_t configuration_dimension() const { return configuration_dimension_; }
  /// The axes that follow them.
  [[nodiscard]] const std::vector<Axis>& velocities() const { return velocities_; }
  [[nodiscard]] std::size_t dimension() const { return configuration_dimension_ + velocities_.size(); }
  [[nodiscard]] const std::vector<ControlAxis>& controls() const { return controls_; }
  /// Seconds of one step.
  [[nodiscard]] double dt() const { return dt_; }

  /// f(x, u).
  virtual void derivative(View x, View u, MutableView rate) const = 0;
  /// Whether a state keeps the limits of the model that are no bounds of single axes.
  [[nodiscard]] virtual bool admits(View x) const {
    static_cast<void>(x);
    return true;
  }

  /// Whether u has as many coordinates as there are controls, each within its bounds.
  [[nodiscard]] bool allows(View u) const;
  /// Brings controls to the nearest within their bounds.
  void clamp(MutableView u) const;
  void sample_control(Stream& stream, MutableView u) const;
  /// One step of explicit Euler, angles brought into the space. `out` may be `x`.
  void step(const Space& space, View x, View u, MutableView out) const;

 protected:
  MotionModel(std::string name, std::string text, std::size_t configuration_dimension, std::vector<Axis> velocities,
              std::vector<ControlAxis> controls, double dt);

 private:
  std::string name_;
  std::string text_;
  std::size_t configuration_dimension_;
  std::vector<Axis> velocities_;
  std::vector<ControlAxis> controls_;
  double dt_;
};

/// A path as it is driven: each row of controls is held for a number of steps.
struct Trajectory {
  Configurations controls;
  std::vector<std::uint32_t> steps;
  double dt = 0.0;

  /// Seconds.
  [[nodiscard]] double duration() const;
};

/// The states that a trajectory passes through: the start, and one after each step. Bit for bit what driving it gave.
/// Throws Error for a control out of its bounds.
Configurations replay(const MotionModel& model, const Space& space, View start, const Trajectory& trajectory);

/// The space of a model's states over a space of configurations. Throws Error where the model moves something else.
Space state_space(const Space& configurations, const MotionModel& model);

/// One kind of motion model: its description and how to make it.
struct MotionKind {
  const Component* component = nullptr;
  std::shared_ptr<const MotionModel> (*make)(const Options&) = nullptr;
};

/// All motion models, in the order of the reference.
const std::vector<MotionKind>& motion_kinds();
/// nullptr for an unknown name.
const MotionKind* find_motion(std::string_view name);

}  // namespace trellis
