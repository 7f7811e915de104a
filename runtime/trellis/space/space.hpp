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
/// A space is a box of axes, some of them periodic, with the weighted Euclidean metric d(a,b) = sqrt(sum_j (w_j *
/// delta_j)^2). delta_j is the difference, on a periodic axis the one of smaller magnitude. "Metric coordinates" are
/// y_j = w_j x_j; volumes and densities refer to them. A space is a value: cheap to copy, compared by content, safe to
/// share between threads.
class Space {
 public:
  Space() = default;
  /// \throws Error when an axis has NaN or infinite bounds, hi <= lo, or a weight that is not positive.
  Space(std::string name, std::vector<Axis> axes);

  /// Returns R^n with the given bounds; the axes are named x, y, z, then q4, q5, ...
  static Space euclidean(const std::vector<std::pair<double, double>>& bounds);
  /// Returns SO(2), angles in [-pi, pi). With the default weight a half turn has length 1 m.
  static Space so2(double weight = 1.0 / std::numbers::pi, const std::string& name = "theta");
  /// Returns SE(2): x, y in the bounds, theta in [-pi, pi), d = sqrt(dx^2 + dy^2 + (w dtheta)^2).
  static Space se2(std::pair<double, double> x, std::pair<double, double> y, double weight = 1.0 / std::numbers::pi);
  /// Returns the product of spaces. Multiplies each factor's metric by its weight; numbers repeated axis names.
  static Space product(const std::vector<std::pair<double, Space>>& factors);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::size_t dimension() const { return axes_.size(); }
  [[nodiscard]] const std::vector<Axis>& axes() const { return axes_; }

  [[nodiscard]] double squared_distance(View a, View b) const;
  [[nodiscard]] double distance(View a, View b) const;
  /// Computes b - a in raw coordinates. On periodic axes takes the difference within half a period; an exact half turn
  /// has a positive sign.
  void difference(View a, View b, MutableView out) const;
  /// Computes the point at parameter t in [0, 1] of the shortest motion from a to b. t = 1 gives b exactly.
  void interpolate(View a, View b, double t, MutableView out) const;
  /// Brings periodic coordinates into [lo, hi).
  void normalise(MutableView q) const;
  /// Reflects bounded coordinates at their bounds and wraps periodic ones: the result lies in the space.
  void reflect(MutableView q) const;
  /// Whether every bounded coordinate lies within its bounds and all are finite.
  [[nodiscard]] bool contains(View q) const;
  void sample_uniform(Stream& stream, MutableView out) const;
  /// Returns the log of the volume in metric coordinates, log|C|.
  [[nodiscard]] double log_volume() const;
  /// Returns the diameter of the space: sqrt(sum (w_j * extent_j)^2), where a periodic axis counts half its period.
  [[nodiscard]] double diameter() const;
  /// Returns half the shortest period in metric coordinates (infinity without a periodic axis): a ball of a smaller
  /// radius does not overlap itself.
  [[nodiscard]] double injectivity_radius() const;

  friend bool operator==(const Space& a, const Space& b) { return a.name_ == b.name_ && a.axes_ == b.axes_; }

 private:
  std::string name_;
  std::vector<Axis> axes_;
};

/// The point of the straight motion from a to b that is nearest to q.
struct Foot {
  double t = 0.0;                 ///< its parameter in [0, 1] from a to b
  double squared_distance = 0.0;  ///< squared distance from it to q
};
Foot nearest_on_motion(const Space& space, View a, View b, View q);

/// log of the volume of the unit ball in R^d.
double log_unit_ball(std::size_t d);

/// Returns the length of a path in the space's metric.
double path_length(const Space& space, const Configurations& path);
/// Returns `count` points, at least 2, evenly spaced along a path, with both ends.
Configurations evenly_spread(const Space& space, const Configurations& path, std::size_t count);

}  // namespace trellis
