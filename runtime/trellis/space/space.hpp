// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/base/random.hpp>

namespace trellis {

/// One coordinate of a space. Lengths in metres, angles in radians.
struct Axis {
  std::string name;       ///< "x", "y", "theta", ...
  double lo = 0.0;        ///< lower bound; for a periodic axis the start of the period
  double hi = 1.0;        ///< upper bound; for a periodic axis lo + period
  double weight = 1.0;    ///< metres of the metric per unit of the coordinate, > 0
  bool periodic = false;  ///< coordinates wrap around at hi

  [[nodiscard]] double period() const { return hi - lo; }
  friend bool operator==(const Axis&, const Axis&) = default;
};

/// A bounded configuration space C: R^n, SO(2), SE(2) and weighted products of these.
///
/// Every such space is a box of axes, some of them periodic, with the weighted Euclidean metric
/// d(a,b) = sqrt(sum_j (w_j * delta_j)^2), delta_j the difference the short way round on a periodic axis.
/// "Metric coordinates" are y_j = w_j x_j; volumes and densities are with respect to them. A space is a value:
/// cheap to copy, equal by content, safe to share between threads.
class Space {
 public:
  Space() = default;
  /// Throws Error when an axis has NaN or infinite bounds, hi <= lo, or a weight that is not positive.
  Space(std::string name, std::vector<Axis> axes);

  /// R^n with the given bounds; axes are named x, y, z, then q4, q5, ...
  static Space euclidean(const std::vector<std::pair<double, double>>& bounds);
  /// SO(2), angles in [-pi, pi). Default weight: a half turn costs 1 m.
  static Space so2(double weight = 1.0 / std::numbers::pi, const std::string& name = "theta");
  /// SE(2): x, y in the bounds, theta in [-pi, pi), d = sqrt(dx^2 + dy^2 + (w dtheta)^2).
  static Space se2(std::pair<double, double> x, std::pair<double, double> y, double weight = 1.0 / std::numbers::pi);
  /// The product of spaces, each factor's metric multiplied by its weight; axis names that repeat get a number.
  static Space product(const std::vector<std::pair<double, Space>>& factors);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::size_t dimension() const { return axes_.size(); }
  [[nodiscard]] const std::vector<Axis>& axes() const { return axes_; }

  [[nodiscard]] double squared_distance(View a, View b) const;
  [[nodiscard]] double distance(View a, View b) const;
  /// b - a in raw coordinates, the short way round on periodic axes (within half a period, the sign of an exact
  /// half turn is positive).
  void difference(View a, View b, MutableView out) const;
  /// The point at share t in [0, 1] of the shortest way from a to b. t = 1 gives b exactly.
  void interpolate(View a, View b, double t, MutableView out) const;
  /// Brings periodic coordinates into [lo, hi).
  void normalise(MutableView q) const;
  /// Reflects coordinates of bounded axes at the walls and wraps periodic ones: the result lies in the space.
  void reflect(MutableView q) const;
  /// Whether every bounded coordinate lies within its bounds and all are finite.
  [[nodiscard]] bool contains(View q) const;
  void sample_uniform(Stream& stream, MutableView out) const;
  /// log of the volume in metric coordinates, log|C|.
  [[nodiscard]] double log_volume() const;
  /// The distance across the space: sqrt(sum (w_j * extent_j)^2), a periodic axis counting half its period.
  [[nodiscard]] double diameter() const;
  /// Half the shortest periodic axis in metric coordinates (infinity without one): balls of a smaller radius do not
  /// meet themselves.
  [[nodiscard]] double injectivity_radius() const;

  friend bool operator==(const Space& a, const Space& b) { return a.name_ == b.name_ && a.axes_ == b.axes_; }

 private:
  std::string name_;
  std::vector<Axis> axes_;
};

/// The point of the straight motion from a to b that is nearest to q.
struct Foot {
  double t = 0.0;                 ///< its place in [0, 1] from a to b
  double squared_distance = 0.0;  ///< between it and q
};
Foot nearest_on_motion(const Space& space, View a, View b, View q);

/// log of the volume of the unit ball in R^d.
double log_unit_ball(std::size_t d);

/// The length of a path in the space's metric.
double path_length(const Space& space, const Configurations& path);
/// So many points, at least 2, evenly spread over a path, both its ends among them.
Configurations evenly_spread(const Space& space, const Configurations& path, std::size_t count);

}  // namespace trellis
