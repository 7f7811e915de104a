// SPDX-License-Identifier: GPL-3.0-or-later
// The path of a run as a motion in time, for controllers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/motion/timed_path.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

/// What joints can do where no file says it.
struct TrajectorySettings {
  double velocity = 1.0;      ///< rad/s or m/s, of joints whose file states none
  double acceleration = 1.0;  ///< rad/s^2 or m/s^2, of all joints: URDF files state none
};

/// Returns the limits of the coordinates of a space: of the joints of a scene's robot those of its URDF file, also
/// those of joints that follow them. \param space  whose first coordinates are the robot's, by name or by place
RateLimits rate_limits(const Scene& scene, const Space& space, const TrajectorySettings& settings);

/// A run whose path is written.
struct TimedRun {
  const Problem* problem = nullptr;
  const RunResult* run = nullptr;
  TimedPath path;
  TrajectorySettings settings;
};

/// Returns the first solved run in the order of problems, strategies and seeds, with its times.
/// \throws Error where no run is solved, and for a robot whose path has times of its own or is not one of joints: with
///     a motion model, or a rotation in space
TimedRun timed_run(const Experiment& experiment, const ExperimentResult& result, const TrajectorySettings& settings);

/// The form of a file of a trajectory: trajectory_msgs/JointTrajectory of ROS in YAML, or a table.
enum class TrajectoryForm { yaml, csv };
/// Returns the form that a name asks for. \throws Error for a name that ends with neither .yaml, .yml nor .csv
TrajectoryForm trajectory_form(const std::string& file);

/// Returns the file: joint names, and for each sample its time, positions and speeds.
std::string trajectory_text(const TimedRun& run, TrajectoryForm form);

}  // namespace trellis
