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

/// One factor of a space: a line or a circle, of one coordinate, or the rotations of space, of four.
struct Factor {
  enum class Kind { line, circle, rotation };
  Kind kind = Kind::line;
  std::size_t column = 0;  ///< of its first coordinate in a row
  Axis axis;               ///< of a line or a circle; of the rotations, name and weight in metres per radian alone

  /// The number of coordinates of a row that it takes, and the number of its degrees of freedom.
  [[nodiscard]] std::size_t width() const { return kind == Kind::rotation ? 4 : 1; }
  [[nodiscard]] std::size_t degrees() const { return kind == Kind::rotation ? 3 : 1; }
  friend bool operator==(const Factor&, const Factor&) = default;
};

/// A bounded configuration space C: R^n, SO(2), SE(2), SO(3), SE(3) and weighted products of these.
///
/// A space is a product of factors (lines, circles, rotations of space) with the metric d(a,b) = sqrt(sum_j (w_j *
/// delta_j)^2). delta_j is the difference, on a circle the one of smaller magnitude, of two rotations the angle of the
/// turn between them in [0, pi]. A space is a value: cheap to copy, compared by content, safe to share between threads.
///
/// A flat space has lines and circles alone: it is a box of axes, some of them periodic. Its "metric coordinates" are
/// y_j = w_j x_j; volumes and densities refer to them. Where a space has rotations, a row holds four coordinates for
/// each, a unit quaternion x, y, z, w, and volumes refer to the metric: a rotation has the volume w^3 8 pi^2.
///
/// The tangent vectors of a space have one number for each degree of freedom, in metres of the metric: `log` and `exp`
/// go to them and back. For flat spaces that is a scaling of coordinates, for rotations it is the rotation vector.
///
/// Views and outputs have `dimension` numbers unless their parameter says otherwise. Only `contains` and `normalise`
/// accept coordinates that are not finite. Sizes are not checked: another one is undefined behaviour.
class Space {
 public:
  Space() = default;
  /// \param name  in messages and files, as "SE(2)"
  /// \param axes  in the order of the coordinates; none makes a space without coordinates
  /// \throws Error when an axis has NaN or infinite bounds, hi <= lo, or a weight that is not positive.
  Space(std::string name, std::vector<Axis> axes);

  // The functions that make spaces throw Error as the constructor does.

  /// Returns R^n with the given bounds; the axes are named x, y, z, then q4, q5, ...
  /// \param bounds  least and greatest coordinate of each axis, in metres
  static Space euclidean(const std::vector<std::pair<double, double>>& bounds);
  /// Returns SO(2), angles in [-pi, pi).
  /// \param weight  metres per radian of turn; with the default a half turn has length 1 m
  /// \param name  of the axis
  static Space so2(double weight = 1.0 / std::numbers::pi, const std::string& name = "theta");
  /// Returns SE(2): x, y in the bounds (metres), theta in [-pi, pi), d = sqrt(dx^2 + dy^2 + (w dtheta)^2).
  /// \param x  least and greatest x, in metres
  /// \param y  least and greatest y, in metres
  /// \param weight  w, metres per radian of turn
  static Space se2(std::pair<double, double> x, std::pair<double, double> y, double weight = 1.0 / std::numbers::pi);
  /// Returns SO(3), the rotations of space, as unit quaternions.
  /// \param weight  metres per radian of turn; with the default a half turn has length 1 m
  /// \param name  of the factor
  static Space so3(double weight = 1.0 / std::numbers::pi, const std::string& name = "rotation");
  /// Returns SE(3): x, y, z in the bounds, then a rotation, d = sqrt(dx^2 + dy^2 + dz^2 + (w angle)^2).
  /// \param bounds  least and greatest x, y and z, in metres
  /// \param weight  metres per radian; the bounding radius of a body makes d a bound on how far its points move
  static Space se3(const std::array<std::pair<double, double>, 3>& bounds, double weight = 1.0 / std::numbers::pi);
  /// Returns the product of spaces. Multiplies each factor's metric by its weight; numbers repeated axis names.
  /// \param factors  a weight greater than 0 and a space, in the order of the coordinates
  static Space product(const std::vector<std::pair<double, Space>>& factors);

  /// Returns the space of some coordinates of this one, with its weights.
  /// \param columns  indices of coordinates, in the order of the result; of a rotation all four in order, or none
  /// \param name  of the result
  /// \throws Fault for a part of a rotation
  /// \throws std::out_of_range for an index of no coordinate
  [[nodiscard]] Space part(const std::vector<std::size_t>& columns, std::string name) const;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// The number of coordinates of a configuration.
  [[nodiscard]] std::size_t dimension() const { return dimension_; }
  /// The number of degrees of freedom, at most `dimension`.
  [[nodiscard]] std::size_t degrees() const { return degrees_; }
  /// Whether the space has no rotations of space, so that its coordinates are independent of one another.
  [[nodiscard]] bool flat() const { return degrees_ == dimension_; }
  [[nodiscard]] const std::vector<Factor>& factors() const { return factors_; }
  /// The coordinates of a flat space.
  /// \throws Fault for a space that is not flat: code that asks for axes does not support rotations
  [[nodiscard]] const std::vector<Axis>& axes() const {
    if (!flat()) not_flat("axes");
    return axes_;
  }

  /// Describes each coordinate of a row, for messages and files: the axes of a flat space; a rotation has four, from -1
  /// to 1, named as "rotation.x".
  [[nodiscard]] std::vector<Axis> coordinates() const;

  /// Returns the square of `distance`, without its square root.
  /// \param a, b  configurations; coordinates of circles need not be normalised
  [[nodiscard]] double squared_distance(View a, View b) const;
  /// Returns d(a, b), in metres of the metric.
  /// \param a, b  configurations; coordinates of circles need not be normalised
  [[nodiscard]] double distance(View a, View b) const;
  /// Computes b - a in raw coordinates of a flat space. On periodic axes takes the difference within half a period; an
  /// exact half turn has a positive sign.
  /// \param a, b  configurations
  /// \param out  receives metres or radians, in the order of the axes; may be `a` or `b`
  /// \throws Fault for a space that is not flat
  void difference(View a, View b, MutableView out) const;
  /// Computes the tangent vector v at a that leads to b: exp(a, v) = b, |v| = distance(a, b).
  /// \param a  the configuration that the vector starts at
  /// \param b  the configuration that it leads to
  /// \param out  `degrees` numbers, metres of the metric; a rotation's are those of its frame at a
  void log(View a, View b, MutableView out) const;
  /// Computes the end of the motion that leaves a along v for |v| metres. It may lie outside the bounds of a line.
  /// \param a  the configuration that the motion leaves
  /// \param v  `degrees` numbers, metres of the metric
  /// \param out  receives the end, with periodic coordinates normalised
  void exp(View a, View v, MutableView out) const;
  /// Returns log of the factor by which `exp` changes volumes at v: 0 in a flat space, less where rotations are. A
  /// point uniform in a ball of volume V of tangent vectors has the density 1 / (V factor) at its end.
  /// \param v  `degrees` numbers, metres of the metric, of a turn of at most pi for each rotation
  [[nodiscard]] double log_jacobian(View v) const;
  /// Maps the unit cube to the space such that equal volumes have equal volumes.
  /// \param u  `degrees` numbers in [0, 1)
  /// \param out  receives the configuration
  void from_unit(View u, MutableView out) const;
  /// Computes the point at parameter t in [0, 1] of the shortest motion from a to b. t = 1 gives b exactly.
  /// \param a, b  the ends of the motion
  /// \param t  0 gives a, 1 gives b
  /// \param out  receives the point; may be `a` or `b` in a flat space
  void interpolate(View a, View b, double t, MutableView out) const;
  /// Brings periodic coordinates into [lo, hi), and quaternions to norm 1 and the sign of `normalised`.
  /// \param q  changed in place; coordinates of lines stay
  void normalise(MutableView q) const;
  /// Reflects bounded coordinates at their bounds and normalises the others: the result lies in the space.
  /// \param q  finite; changed in place
  void reflect(MutableView q) const;
  /// Whether every bounded coordinate lies within its bounds, all are finite, and quaternions have norm 1 within 1e-9.
  /// \param q  of any size; false for another than `dimension`
  [[nodiscard]] bool contains(View q) const;
  /// Draws a configuration uniformly by volume.
  /// \param stream  draws `degrees` numbers
  /// \param out  receives the configuration, inside the space
  void sample_uniform(Stream& stream, MutableView out) const;
  /// Returns the natural logarithm of the volume |C|, in metres of the metric to the power of `degrees`.
  [[nodiscard]] double log_volume() const;
  /// Returns the diameter of the space in metres of the metric: sqrt(sum (w_j * extent_j)^2), where a periodic axis
  /// counts half its period and a rotation a half turn.
  [[nodiscard]] double diameter() const;
  /// Returns half the shortest period in the metric (infinity without circles and rotations): a ball of a smaller
  /// radius does not overlap itself.
  [[nodiscard]] double injectivity_radius() const;

  /// Whether names and factors are the same, weights and bounds included.
  /// \param a, b  of any dimensions
  friend bool operator==(const Space& a, const Space& b) { return a.name_ == b.name_ && a.factors_ == b.factors_; }

 private:
  /// \param factors  their columns are assigned here
  Space(std::string name, std::vector<Factor> factors);
  [[noreturn]] void not_flat(const char* what) const;

  std::string name_;
  std::vector<Factor> factors_;
  std::vector<Axis> axes_;  ///< of a flat space, else empty
  std::size_t dimension_ = 0;
  std::size_t degrees_ = 0;
};

/// The point of the straight motion from a to b that is nearest to q.
struct Foot {
  double t = 0.0;                 ///< its parameter in [0, 1] from a to b
  double squared_distance = 0.0;  ///< squared distance from it to q
};
/// Returns that point in the metric of the space; where rotations turn, it searches for it.
/// \param space  that of the configurations
/// \param a, b  the ends of the motion
/// \param q  the configuration that the point is nearest to
Foot nearest_on_motion(const Space& space, View a, View b, View q);

/// Returns the natural logarithm of the volume of the unit ball in R^d.
/// \param d  at least 0; the ball of R^0 has the volume 1
double log_unit_ball(std::size_t d);

/// Returns the length of a path: the sum of the distances between its points, in metres of the metric; 0 of an empty
/// one.
/// \param space  that of the path
/// \param path  configurations of the space, which is not checked
double path_length(const Space& space, const Configurations& path);
/// Returns points that are evenly spaced along a path, both ends included.
/// \param space  that of the path
/// \param path  at least one configuration
/// \param count  at least 2
/// \return `count` configurations; neighbours have equal distances along the path, in metres of the metric
Configurations evenly_spread(const Space& space, const Configurations& path, std::size_t count);

}  // namespace trellis
