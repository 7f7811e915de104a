// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// A found path passes a final check before it is reported: its motions at this many times the problem's resolution.
inline constexpr double path_check_refinement = 4.0;

/// The first invalid place of a path.
struct InvalidPlace {
  enum class Kind : std::uint8_t {
    outside,  ///< the point lies outside of the space
    point,    ///< the point is invalid
    motion,   ///< the motion to the point is invalid
  };
  Kind kind = Kind::point;
  std::size_t point = 0;  ///< index into the path
  Configuration invalid;  ///< the first invalid configuration
};

/// Finds the first invalid place of a path, by the instance's validity and resolution. A motion must be valid in both
/// directions: rounding differs, and a planner may have checked it from the other end.
/// \param path  configurations of the instance's space, or states
/// \return none where the path is valid
std::optional<InvalidPlace> first_invalid_place(Instance& instance, const Configurations& path);

/// Returns the problem with a resolution that is finer by `path_check_refinement`.
Problem with_finer_motions(Problem problem);

/// Returns why a path does not solve a problem: it does not begin at the start, does not end at a goal, leaves the
/// space, or is invalid at a configuration or on a motion, by the problem's collision backend and resolution. The text
/// names the invalid configuration and the robot's contact there.
/// \param path  configurations, or states where the problem has a motion model
/// \return the fault, as the end of a sentence that begins with "the path"; "" if the path solves the problem
std::string path_fault(const Problem& problem, const Configurations& path);

/// Returns why a trajectory does not drive along a path: a control is out of bounds, or its states, step by step,
/// differ from those of the path (distances above 1e-9 m in the metric).
/// \param problem  with a motion model
/// \return as path_fault
std::string trajectory_fault(const Problem& problem, const Configurations& path, const Trajectory& trajectory);

}  // namespace trellis
