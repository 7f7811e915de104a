// SPDX-License-Identifier: GPL-3.0-or-later
// A rigid body among solids and meshes of space, as its own narrow phase and as a part of a team's.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>

#include <trellis/collision/narrow_phase.hpp>
#include <trellis/collision/spatial/separation.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/space/rotation.hpp>

namespace trellis {

/// A motion of a body in the frame of a narrow phase's world, seen from one of its configurations.
struct SeenMotion {
  Pose3 pose;                 ///< of the body there
  BodyMotion whole;           ///< translation and turn of the whole motion; its reference is not used
  double displacement = 0.0;  ///< metres, at most, that points of the body move against the solids on the whole motion
  double rest = 0.0;          ///< the part of it that `whole` leaves out, since the solids turn

  /// The part of the motion within `half` of it to either side.
  [[nodiscard]] BodyMotion part(double half) const {
    return {pose.position, half * whole.translation, whole.axis, half * whole.turn};
  }
};

/// Returns translation and turn from one pose to another, about an axis in the frame of the world; without a reference.
BodyMotion body_motion(const Pose3& from, const Pose3& to);

/// Marks the configurations of a motion, by index, that the clearance of one of them shows to be free.
/// \param free  a number for each of 0..n
/// \param per_configuration  metres that the robot's points move from one configuration to the next, at most
inline void mark_free(char* free, std::uint32_t n, std::uint32_t index, double clearance, double per_configuration) {
  if (!(clearance > per_configuration)) return;
  const auto steps = static_cast<std::uint32_t>(std::min(clearance / per_configuration, static_cast<double>(n)));
  const std::uint32_t first = index > steps ? index - steps : 0, last = std::min(n, index + steps);
  std::fill(free + first, free + last + 1, char{1});
}

/// Returns how far the shares of a motion are from those that a level of the bisection visited before, by rank.
inline double gap_before(std::uint32_t rank) {
  double gap = 1.0;
  for (std::uint32_t level = rank; level > 0; level /= 2) gap *= 0.5;
  return gap;
}

/// The narrow phase of a rigid body, which also answers about poses.
class BodyPhase : public NarrowPhase {
 public:
  /// Whether the body at a pose is valid.
  [[nodiscard]] virtual bool valid_at(const Pose3& pose) const = 0;
  /// Returns a distance in metres that the body at a pose certainly has from the boundary and all obstacles; negative
  /// where the pose is invalid.
  /// \param enough  the search for a larger distance may end at this one
  [[nodiscard]] virtual double sure_clearance(const Pose3& pose, double enough) const = 0;
  /// Returns the distance in metres of the body at a pose from the nearest obstacle or, from inside, the boundary.
  /// \param pose  valid
  [[nodiscard]] virtual double clearance_at(const Pose3& pose) const = 0;
  /// Returns the first obstacle that the body at a pose meets; none where it meets none.
  [[nodiscard]] virtual std::optional<std::size_t> met_obstacle(const Pose3& pose) const = 0;
  /// Whether everything is certainly farther than `margin` metres from the body throughout the part of its motion
  /// within `half` of it to either side.
  [[nodiscard]] virtual bool apart_throughout(const SeenMotion& motion, double half, double margin) const = 0;
  /// Returns the distance at the middle of such a part, as MotionClearance::near.
  [[nodiscard]] virtual MotionClearance::Near near_throughout(const SeenMotion& motion, double half,
                                                              double at_most) const = 0;
};

/// Returns the narrow phase of a rigid body by FCL.
/// \param scene  of one body in space, not nullptr; the narrow phase shares its ownership
/// \param space  copied; fits the scene (check_fits)
/// \param filtered  as of make_spatial_checker
std::unique_ptr<BodyPhase> make_body_phase(std::shared_ptr<const Scene> scene, const Space& space, bool filtered);

/// Returns the narrow phase of a team of rigid bodies.
/// \param scene  of a team of bodies in space, not nullptr; the narrow phase shares its ownership
/// \param space  copied; fits the scene (check_fits)
/// \param filtered  as of make_spatial_checker
std::unique_ptr<NarrowPhase> make_team_phase(std::shared_ptr<const Scene> scene, const Space& space, bool filtered);

}  // namespace trellis
