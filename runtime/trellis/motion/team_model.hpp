// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <trellis/motion/motion_model.hpp>

namespace trellis {

/// The motion model of a team: each robot is driven by a model of its own, all at the same time. A state holds the
/// configurations of all robots, then their velocities in the same order; a control holds those of all robots, one
/// after the other. A step of a team takes each robot to the same state, bit for bit, as a step of its own model.
class TeamModel final : public MotionModel {
 public:
  /// One robot.
  struct Part {
    std::shared_ptr<const MotionModel> model;
    std::vector<std::size_t> columns;  ///< of a state of the team, those of its own state in order
    std::size_t control = 0;           ///< of a control of the team, its first coordinate

    /// Its part of a control of the team.
    [[nodiscard]] View own(View u) const { return u.subspan(control, model->controls().size()); }
  };

  /// \param models  one for each robot, none of a team
  /// \param axes    of each robot, its coordinates in a configuration of the team, ascending
  /// \throws Error where a model does not fit its robot, or the models take steps of different durations
  TeamModel(const std::vector<std::shared_ptr<const MotionModel>>& models,
            const std::vector<std::vector<std::size_t>>& axes);

  void derivative(View x, View u, MutableView rate) const override;
  [[nodiscard]] double step_work() const override { return step_work_; }
  [[nodiscard]] bool admits(View x) const override;

  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }

 private:
  std::vector<Part> parts_;
  double step_work_ = 0.0;
};

/// How far robots are along a motion found before, in seconds: it continues, or stands still while they wait, and never
/// goes back.
class PathClock final : public MotionModel {
 public:
  /// \param duration  of the motion, a whole number of steps
  /// \param dt        of a step; both in seconds
  PathClock(double duration, double dt);

  /// \param u  from 0.5 on it continues
  void derivative(View x, View u, MutableView rate) const override;
  /// The controls that bring it to a time; none where that is past.
  [[nodiscard]] std::optional<Trajectory> to(double from, double until) const;

 private:
  double duration_;
};

/// Returns the model as that of a team; nullptr where it is one of a robot alone.
const TeamModel* team_model(const MotionModel& model);

/// Whether a robot of this model can wait at any of its states, by the control 0.
bool can_wait(const MotionModel& model);

}  // namespace trellis
