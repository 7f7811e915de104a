// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/scene/scene.hpp>

namespace trellis {

/// What checking a motion found.
struct MotionReport {
  bool valid = false;
  /// Configurations whose validity was decided: in bisection order (the end first, then the middle, the quarters, ...)
  /// up to and including the first invalid one; all of them for a valid motion. The same for every backend, however
  /// many are looked at in one step.
  std::uint32_t checks = 0;
  /// Where on [0, 1] from a to b the first invalid configuration (in that order) lies; NaN for a valid motion.
  double invalid_at = std::numeric_limits<double>::quiet_NaN();
};

/// What a configuration touches.
struct Contact {
  std::size_t body = 0;                   ///< of the robot
  std::optional<std::size_t> obstacle;    ///< of the world; none: the boundary, or another body
  std::optional<std::size_t> other = {};  ///< the body of the robot that it meets
};

/// Validity of configurations and motions of a robot in a world. The robot is valid where it lies inside the closed
/// boundary box and touches no (closed) obstacle, and where no two of its bodies that are to be kept apart
/// (Robot::pairs) touch each other; others may overlap. Touching is meant to within
/// rounding: gaps below 2^-43 (1e-13) of the world's size count as touching, and the boundary gives way by as much. A
/// configuration with a coordinate that is not finite is invalid.
///
/// A motion from a to b is looked at in n = max(1, ceil(displacement_bound(a, b) / resolution)) configurations,
/// interpolate(a, b, i / n), i = 1..n: b is one of them, a is taken as checked. They are visited in bisection order:
/// n first, then the midpoints of [0, n], level by level from the left.
///
/// A checker has scratch memory: one thread at a time. Make one per level and run; making one is cheap for small
/// worlds.
class Checker {
 public:
  virtual ~Checker() = default;

  [[nodiscard]] virtual bool valid(View q) const = 0;
  [[nodiscard]] virtual MotionReport motion(View a, View b) const = 0;
  /// The distance from the robot at q to the nearest obstacle or, from inside, to the boundary, and between bodies that
  /// are to be kept apart; 0 in collision.
  [[nodiscard]] virtual double clearance(View q) const = 0;
  /// A lower bound, in the space's metric, on the distance from q to the nearest valid configuration: every
  /// configuration nearer than that is invalid too. 0 where q is valid or nothing is known; at most the diameter of the
  /// space. Decides no validity: a caller asks for it at a configuration found invalid.
  [[nodiscard]] virtual double invalid_radius(View q) const {
    static_cast<void>(q);
    return 0.0;
  }
  /// What the robot at q touches, the first in order of bodies and obstacles, then of pairs of bodies; none when q is
  /// valid.
  [[nodiscard]] virtual std::optional<Contact> contact(View q) const = 0;
};

/// Our own backend: separating axes and exact distances, eight poses of an edge per step, culling by the edge's swept
/// box through a grid over the obstacles.
std::unique_ptr<Checker> make_planar_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution);
/// FCL's (fcl_checker.cpp is the only source that meets it): the planar parts as prisms under a dynamic tree.
std::unique_ptr<Checker> make_fcl_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution);
/// By name: "planar" or "fcl". Throws Error for another name.
std::unique_ptr<Checker> make_checker(const std::string& backend, std::shared_ptr<const Scene> scene,
                                      const Space& space, double resolution);

/// What it is in collision with: "obstacle 3 (box 4 0 6 4.75)", "the world's boundary" or "itself (link 1 meets link
/// 3)".
std::string describe(const Contact& contact, const Scene& scene);

/// The order in which the configurations 1..n of a motion are visited: n, then midpoints level by level. 0-based rank
/// to index.
std::vector<std::uint32_t> bisection_order(std::uint32_t n);

}  // namespace trellis
