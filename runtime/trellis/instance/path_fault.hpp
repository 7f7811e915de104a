// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// The first place at which a path is not certified.
struct InvalidPlace {
  enum class Kind : std::uint8_t {
    outside,  ///< the point lies outside of the space
    point,    ///< the point is invalid
    motion,   ///< the motion to the point is in contact, or too close to contact to decide
  };
  Kind kind = Kind::point;
  std::size_t point = 0;  ///< index into the path
  Configuration invalid;  ///< a configuration in contact, or close to it
};

/// What is known of a path for every configuration on it, not only for those that a search checked.
struct PathCertificate {
  /// The place that refutes the path; none where the path is certified: its points are valid, and everywhere on its
  /// motions the robot's distance from obstacles, boundary and, of self-collision pairs, from itself is greater than 0.
  std::optional<InvalidPlace> refuted;
  /// In metres: a lower bound on these distances, within a tenth of the least one (Certificate::clearance); infinity
  /// where nothing limits the robot. 0 of a path that is refuted.
  double clearance = 0.0;
  std::uint64_t checks = 0;  ///< configurations checked for it

  [[nodiscard]] bool certified() const { return !refuted; }
};

/// Certifies a path, or finds a place that refutes it.
/// \param space  of the path's configurations, or states
/// \param validity  of that space; must check collisions
/// \param tolerance  metres, see Certificate::tolerance
PathCertificate certify(const Space& space, Validity& validity, const Configurations& path, double tolerance);

/// Returns the tolerance of certificates for a problem: its `contact_tolerance`, or where that is 0 a millionth of its
/// resolution; in metres.
double certificate_tolerance(const Problem& problem);

/// Returns why a path does not solve a problem: it does not begin at the start, does not end at a goal, leaves the
/// space, or is not certified. The text names the configuration and the robot's contact there.
/// \param path  configurations, or states where the problem has a motion model
/// \param clearance  if not null: receives that of the certificate, in metres
/// \return the fault, as the end of a sentence that begins with "the path"; "" if the path solves the problem
std::string path_fault(const Problem& problem, const Configurations& path, double* clearance = nullptr);

/// Returns why a path is invalid at the configurations that the problem's resolution checks, by its collision backend:
/// a second opinion on a certified path, by another backend and more configurations than the search had. \return as
/// path_fault
std::string checked_fault(const Problem& problem, const Configurations& path);

/// Returns why a trajectory does not drive along a path: a control is out of bounds, or its states, step by step,
/// differ from those of the path (distances above 1e-9 m in the metric).
/// \param problem  with a motion model
/// \return as path_fault
std::string trajectory_fault(const Problem& problem, const Configurations& path, const Trajectory& trajectory);

}  // namespace trellis
