// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/collision/certificate.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/space/rotation.hpp>

namespace trellis {

class NarrowPhase;

/// The result of the validity check of a motion.
struct MotionReport {
  bool valid = false;
  /// The number of configurations whose validity the checker decided, in bisection order (the end first, then the
  /// middle, the quarters, ...): up to and including the first invalid one, or all of a valid motion. Every backend
  /// gives the same number, however many configurations it checks in one step.
  std::uint32_t checks = 0;
  /// The parameter on [0, 1] from a to b of the first invalid configuration (in that order); NaN for a valid motion. Of
  /// a point it may lie between the checked configurations.
  double invalid_at = std::numeric_limits<double>::quiet_NaN();
};

/// A contact of the robot at a configuration.
struct Contact {
  std::size_t body = 0;                   ///< the robot's body
  std::optional<std::size_t> obstacle;    ///< the obstacle of the world; none: the boundary, or another body
  std::optional<std::size_t> other = {};  ///< the robot's other body of the contact
  std::string link = {};        ///< of `body`, in contact with `other_link`; "" where the bodies' names say it
  std::string other_link = {};  ///< of `other`
};

/// CPU time of collision checks, in units of work (search_cost). It follows the robot and the world, not the backend.
struct CheckCost {
  double on_motion = 1.0;  ///< of one configuration on a motion
  double alone = 1.0;      ///< of one configuration that is on none
  double distance = 3.0;   ///< of a distance from obstacles, the check included
  double motion = 0.0;     ///< of a motion, without its configurations
};

/// The obstacle nearest to the robot at a configuration.
struct Proximity {
  std::size_t obstacle = 0;  ///< of the world; the first of those at the same distance
  double distance = 0.0;     ///< metres; 0: the robot touches it
  /// The obstacle's point that is nearest to the robot, with z = 0 in the plane; none where the robot touches the
  /// obstacle, or where the backend has no such point.
  std::optional<Vec3> point = {};
};

/// Checks the validity of configurations and motions of a robot in a world. A configuration is valid if the robot lies
/// inside the closed boundary box and touches no (closed) obstacle, and if the two bodies of no self-collision pair
/// (Robot::pairs) touch each other; other bodies may overlap. Touching allows for rounding: a gap below 2^-43 (1e-13)
/// of the world's size counts as touching, and the boundary grows by as much. A configuration with a coordinate that is
/// not finite is invalid.
///
/// The checker validates a motion from a to b at n = max(1, ceil(displacement_bound(a, b) / resolution))
/// configurations, interpolate(a, b, i / n), i = 1..n: b is one of them, and the caller has validated a. It visits them
/// in bisection order: n first, then the midpoints of [0, n], level by level from the left. The motion of a point is a
/// segment: it is valid where these configurations are and the segment touches no closed obstacle anywhere, exactly; it
/// counts n checks too. Of other robots `certify` decides the places between the configurations.
///
/// Configurations have the space's `dimension` numbers, which is not checked: another size is undefined behaviour.
///
/// A checker has scratch memory: only one thread may use it at a time. Create one per level and run; construction is
/// cheap for small worlds.
class Checker final {
 public:
  /// The functions below make checkers (make_checker).
  /// \param scene  of the narrow phase; used during the call only
  /// \param phase  not nullptr: contacts and distances of the scene's robot
  /// \param resolution  as of make_planar_checker; it is not checked
  Checker(const Scene& scene, std::unique_ptr<NarrowPhase> phase, double resolution);
  Checker(const Checker&) = delete;
  Checker& operator=(const Checker&) = delete;
  ~Checker();

  /// Whether q is valid, as defined above.
  /// \param q  any coordinates, NaN and infinity too
  [[nodiscard]] bool valid(View q) const;
  /// Validates the motion from a to b.
  /// \param a  valid; it is not checked
  /// \param b  the end, which is checked
  /// \throws Error for a motion whose n exceeds 2^26
  [[nodiscard]] MotionReport motion(View a, View b) const { return validate(a, b, 0); }
  /// The same where n is known.
  /// \param a  valid; it is not checked
  /// \param b  the end, which is checked
  /// \param n  as defined above; 0: it is computed
  /// \throws Error for a motion whose n exceeds 2^26
  [[nodiscard]] MotionReport validate(View a, View b, std::uint32_t n) const;
  /// Returns n as defined above: what `motion` checks at most.
  /// \param a, b  the ends of the motion
  /// \throws Error for a motion whose n exceeds 2^26
  [[nodiscard]] std::uint32_t most_checks(View a, View b) const;
  /// Adds the motion from a to b, both included, to a certificate that is valid so far. What has no collision geometry,
  /// the bounds of the space and limits of a motion model, is not part of it.
  /// \param a, b  the ends of the motion
  /// \param certificate  not refuted; receives distances, checks and the place where the motion is refuted
  void certify(View a, View b, Certificate& certificate) const;
  /// Returns the distance in metres from the robot at q to the nearest obstacle or, from inside, to the boundary, and
  /// between the bodies of self-collision pairs; 0 in collision.
  /// \param q  finite coordinates
  [[nodiscard]] double clearance(View q) const;
  /// Returns the obstacle of the world that is nearest to the robot at q; none without obstacles. Unlike `clearance` it
  /// considers neither the boundary nor self-collision pairs.
  /// \param q  finite coordinates
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) const;
  /// Returns a lower bound, in the space's metric, on the distance from q to the nearest valid configuration: every
  /// nearer configuration is invalid too. 0 where q is valid or the checker has no bound; at most the diameter of the
  /// space. Does not decide validity: call it at an invalid configuration.
  /// \param q  invalid; it is not checked
  [[nodiscard]] double invalid_radius(View q) const;
  /// Returns the contact of the robot at q, the first in the order of bodies and obstacles, then of self-collision
  /// pairs; none when q is valid.
  /// \param q  valid or not
  [[nodiscard]] std::optional<Contact> contact(View q) const;
  /// Returns what its checks cost.
  [[nodiscard]] const CheckCost& cost() const { return cost_; }

 private:
  std::unique_ptr<NarrowPhase> phase_;  ///< the backend's part
  std::size_t dimension_;               ///< of the coordinates that move the robot, which come first
  double resolution_;
  CheckCost cost_;
};

/// Returns Trellis' own backend: separating axes and exact distances, eight poses of a motion per step. A grid over the
/// obstacles culls them by the swept box of the motion.
/// \param scene  not nullptr; the checker shares its ownership
/// \param space  copied; its first coordinates are the robot's
/// \param resolution  of all backends: metres that the robot's fastest point moves between two checked configurations
/// \throws Fault for a scene that is not of the plane
/// \throws Error for a resolution that is not finite and greater than 0, a robot without bodies, and a space with fewer
///     coordinates than the robot
std::unique_ptr<Checker> make_planar_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution);
/// Returns the FCL backend: the planar parts as prisms in a dynamic tree. Only fcl_checker.cpp includes FCL.
/// \param scene  planar, not nullptr; the checker shares its ownership
/// \param space  copied; its first coordinates are the robot's
/// \param resolution  as of make_planar_checker
/// \throws Error as make_planar_checker
/// \throws Fault for a scene that is not of the plane
std::unique_ptr<Checker> make_fcl_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution);
/// Returns the FCL backend of space, for rigid bodies among solids and meshes.
/// \param scene  of bodies in space, not nullptr; the checker shares its ownership
/// \param space  copied; its first coordinates are the robot's
/// \param resolution  as of make_planar_checker
/// \param filtered  whether sphere covers and a distance field decide what they can before FCL; same answers and counts
/// \throws Error as make_planar_checker
/// \throws Fault for a scene that is not of bodies in space
std::unique_ptr<Checker> make_spatial_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution,
                                              bool filtered = true);
/// Returns the backend of manipulators: balls among the obstacles of space, and against each other.
/// \param scene  of a manipulator, not nullptr; the checker shares its ownership
/// \param space  copied; its first coordinates are the robot's
/// \param resolution  as of make_planar_checker
/// \throws Error as make_planar_checker
std::unique_ptr<Checker> make_sphere_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution);
/// Returns the names of the backends of a scene, its default first: "planar" and "fcl" in the plane, "fcl" and
/// "fcl_plain" of bodies in space, "spheres" of manipulators.
/// \param scene  of any kind
std::vector<std::string> collision_backends(const Scene& scene);
/// Returns a backend by name.
/// \param backend  a name of collision_backends()
/// \param scene  not nullptr; the checker shares its ownership
/// \param space  copied; its first coordinates are the robot's
/// \param resolution  as of make_planar_checker
/// \throws Error for a name that the scene has not, and as make_planar_checker
std::unique_ptr<Checker> make_checker(const std::string& backend, std::shared_ptr<const Scene> scene,
                                      const Space& space, double resolution);

/// Describes the contact: "obstacle 3 (box 4 0 6 4.75)", "the world's boundary" or "itself (link 1 meets link 3)".
/// \param contact  in `scene`
/// \param scene  names the bodies and the obstacles
std::string describe(const Contact& contact, const Scene& scene);

/// Returns the order in which checkers visit the configurations 1..n of a motion: n, then midpoints level by level.
/// Maps the 0-based rank to the index.
/// \param n  number of configurations; 0 gives none
std::vector<std::uint32_t> bisection_order(std::uint32_t n);

}  // namespace trellis
