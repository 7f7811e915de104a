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
  double lo = 0.0;   ///< least value, in SI units: m/s, rad, m/s^2
  double hi = 0.0;   ///< greatest value
};

/// The kinodynamic model of a robot: dx/dt = f(x, u), integrated with explicit Euler steps. A state x is a
/// configuration (x, y, theta, perhaps theta of a trailer) followed by velocities. Immutable; safe to share between
/// threads.
class MotionModel {
 public:
  MotionModel(const MotionModel&) = delete;
  MotionModel& operator=(const MotionModel&) = delete;
  virtual ~MotionModel() = default;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Returns the model in the syntax of a script: "unicycle1 { max_speed = 0.3 }".
  [[nodiscard]] const std::string& text() const { return text_; }
  /// Returns the number of coordinates of a configuration; they come first in a state.
  [[nodiscard]] std::size_t configuration_dimension() const { return configuration_dimension_; }
  /// Returns the axes of the velocities, which follow the configuration.
  [[nodiscard]] const std::vector<Axis>& velocities() const { return velocities_; }
  [[nodiscard]] std::size_t dimension() const { return configuration_dimension_ + velocities_.size(); }
  [[nodiscard]] const std::vector<ControlAxis>& controls() const { return controls_; }
  /// Returns the duration of one step, in seconds.
  [[nodiscard]] double dt() const { return dt_; }

  /// Computes f(x, u) into `rate`.
  /// \param x  a state: `dimension` numbers, as all states below; another size is undefined behaviour
  /// \param u  a number for each control, as all controls below
  /// \param rate  receives `dimension` numbers, per second
  virtual void derivative(View x, View u, MutableView rate) const = 0;
  /// Returns the work of a step: CPU time in units of 0.07 us, as costs count it.
  [[nodiscard]] virtual double step_work() const { return 0.5; }
  /// Whether a state satisfies those limits of the model that are not bounds of single axes.
  /// \param x  a state
  [[nodiscard]] virtual bool admits(View x) const {
    static_cast<void>(x);
    return true;
  }

  /// Whether u has one coordinate for each control, each within its bounds.
  /// \param u  of any size
  [[nodiscard]] bool allows(View u) const;
  /// Clamps each control to its bounds.
  /// \param u  a number for each control, not NaN; changed in place
  void clamp(MutableView u) const;
  /// Draws each control uniformly between its bounds.
  /// \param stream  draws a number for each control
  /// \param u  receives the control
  void sample_control(Stream& stream, MutableView u) const;
  /// Takes one explicit Euler step and normalises the angles. `out` may be `x`.
  /// \param space  the state space, in which the result is normalised
  /// \param x  the state before the step
  /// \param u  the control, constant during the step; its bounds are not checked
  /// \param out  receives the state after the step, `dimension` numbers
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

/// A sequence of controls; each row of controls is constant over a number of steps.
struct Trajectory {
  Configurations controls;           ///< a number for each control of the model
  std::vector<std::uint32_t> steps;  ///< of each row
  double dt = 0.0;                   ///< duration of a step, in seconds

  /// Returns the duration in seconds.
  [[nodiscard]] double duration() const;
};

/// Returns the states of a trajectory: the start, and the state after each step. The result equals that of the
/// planner's propagation bit for bit.
/// \param model  of the trajectory
/// \param space  the state space of the model
/// \param start  a state
/// \param trajectory  as many entries of `steps` as rows of `controls`; its `dt` is not read
/// \return one row more than the trajectory has steps
/// \throws Error for a control out of its bounds.
Configurations replay(const MotionModel& model, const Space& space, View start, const Trajectory& trajectory);

/// Returns the state space of a model over a space of configurations.
/// \param configurations  flat
/// \param model  its velocities become the last axes
/// \return `configurations` itself where the model has no velocities
/// \throws Error where the model's configuration has another number of coordinates than the space
Space state_space(const Space& configurations, const MotionModel& model);

/// One kind of motion model: its description and its factory.
struct MotionKind {
  const Component* component = nullptr;
  std::shared_ptr<const MotionModel> (*make)(const Options&) = nullptr;
};

/// Returns all motion models, in the order of the reference. Thread-safe.
const std::vector<MotionKind>& motion_kinds();
/// Returns the model with this name; nullptr for an unknown name. Thread-safe.
/// \param name  as in scripts: "unicycle1"
/// \return valid as long as the program
const MotionKind* find_motion(std::string_view name);

}  // namespace trellis
