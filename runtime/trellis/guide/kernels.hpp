// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/base/random.hpp>
#include <trellis/planner/density.hpp>
#include <trellis/space/nearest.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

// Distributions with closed densities, from which heuristics are made. Densities are with respect to volume in metric
// coordinates. Samples beyond a bound of the space are reflected into it, so every density integrates to 1 over the
// space.

/// The largest radius not above `wanted` at which a ball overlaps neither itself across a period nor two opposite
/// bounds of the space.
double fitting_radius(const Space& space, double wanted);

/// Uniform on the metric ball about a centre. In a space with rotations uniform on the ball of tangent vectors, whose
/// end `exp` is drawn: the density is 1 / (volume of the ball) divided by the factor by which exp changes volumes.
class BallKernel {
 public:
  /// \param radius  metres in the metric, > 0; fitting_radius reduces it if necessary
  BallKernel(Space space, double radius);
  void sample(View centre, Stream& stream, MutableView out) const;
  [[nodiscard]] double density(View centre, View q) const;
  /// The density at the end of the tangent vector from the centre to an image of a configuration, not reflected at
  /// bounds; 0 beyond the radius.
  [[nodiscard]] double density_in_tangent(View centre, View image) const;
  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] double log_volume() const { return log_volume_; }
  [[nodiscard]] const Space& space() const { return space_; }

 private:
  void sample_tangent(View centre, Stream& stream, MutableView out) const;

  Space space_;
  double radius_;
  double log_volume_;
};

/// A path and the balls about its points. All densities of the same path share it.
class Tube {
 public:
  /// \param path  at least one configuration of the space
  /// \param radius  metres in the metric, > 0; fitting_radius reduces it if necessary
  Tube(const Space& space, Configurations path, double radius);

  [[nodiscard]] double length() const { return at_.back(); }
  [[nodiscard]] const BallKernel& ball() const { return ball_; }
  [[nodiscard]] const Configurations& path() const { return path_; }
  /// Arc length up to each point of the path, in metres in the metric.
  [[nodiscard]] const std::vector<double>& at() const { return at_; }
  /// The point of the path at arc length s.
  void point(double s, MutableView out) const;
  /// The arc length of the centre of the ball that is drawn from at arc length s: s itself; in a space with rotations
  /// that of the nearest of centres `spacing` apart, so that densities are finite sums.
  [[nodiscard]] double centre_at(double s) const;
  /// At most a quarter of the radius; 0: all points of the path are centres.
  [[nodiscard]] double spacing() const { return spacing_; }

 private:
  BallKernel ball_;
  Configurations path_;
  std::vector<double> at_;
  double spacing_ = 0.0;
};

/// A mixture of balls of equal radius about points of tubes; the centres are uniform in arc length over intervals of
/// the paths. `at` finds the few legs near a configuration in a tree of bounding boxes, whatever the number of tubes
/// and intervals.
class TubeDensity final : public Density {
 public:
  struct Stretch {
    double from = 0.0;  ///< arc length
    double to = 0.0;    ///< >= `from`; equal: a single point
    double mass = 0.0;
  };
  struct Part {
    std::shared_ptr<const Tube> tube;
    std::vector<Stretch> stretches;  ///< disjoint except for end points
  };

  /// \param parts  at least one; all with the same space and radius
  explicit TubeDensity(std::vector<Part> parts);
  /// A single interval of one tube. It needs no allocation for its parts; a search records many of these.
  TubeDensity(std::shared_ptr<const Tube> tube, const Stretch& stretch);

  [[nodiscard]] double at(View q) const override;
  /// True for another tube density with the same space and radius.
  [[nodiscard]] bool mergeable(const Density& other) const override;
  /// Adds the weights of equal tubes, interval by interval.
  [[nodiscard]] std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const override;

 private:
  /// A segment from p to p + v in metric coordinates, unwrapped. `numbers_` stores p and v.
  struct Leg {
    double length = 0.0;
    double rate = 0.0;  ///< mass per metre; the mass itself if the length is 0
  };
  struct Node {
    std::uint32_t begin = 0;  ///< first leg
    std::uint32_t end = 0;
    std::uint32_t right = 0;  ///< index of the second child, the first child is the next node; 0: a leaf
  };

  /// The centres of balls in a space with rotations.
  struct Centres {
    explicit Centres(const Space& space) : index(space), rows(space.dimension()) {}
    NearestIndex index;
    Configurations rows;
    std::vector<double> mass;
  };

  /// Builds the data that `at` reads. Not done at construction, because most densities of a run are only summed.
  void index() const;
  void add_legs(const Tube& tube, const Stretch& stretch) const;
  void add_centres(const Tube& tube, const Stretch& stretch) const;
  [[nodiscard]] double at_centres(View q) const;
  /// Calls f(tube, stretch) for every interval.
  template <class F>
  void for_each_stretch(const F& f) const {
    if (parts_.empty()) f(tube_, stretch_);
    for (const auto& part : parts_) {
      for (const auto& stretch : part.stretches) f(part.tube, stretch);
    }
  }
  std::uint32_t build(std::vector<std::uint32_t>& order, std::uint32_t begin, std::uint32_t end) const;
  /// The mass of ball centres within the radius of y, an image of a configuration in metric coordinates.
  [[nodiscard]] double mass_near(const double* y) const;
  [[nodiscard]] double mass_near(const Leg& leg, const double* numbers, const double* y) const;

  std::shared_ptr<const Tube> tube_;  ///< the first tube
  Stretch stretch_;                   ///< the only interval, of the first tube, if `parts_` is empty
  std::vector<Part> parts_;
  const Space& space_;
  double radius_;
  double height_;  ///< density of one ball
  mutable std::once_flag indexed_;
  mutable std::vector<Leg> legs_;
  mutable std::vector<double> numbers_;
  mutable std::vector<Node> nodes_;
  mutable std::vector<double> boxes_;  ///< per node: lower corner, then upper corner
  mutable std::unique_ptr<Centres> centres_;
};

/// The tube about a path: draws a point of the path uniformly in arc length over the active intervals, then a
/// configuration uniformly from the ball about it.
class TubeKernel {
 public:
  TubeKernel(const Space& space, Configurations path, double radius);

  /// Sets the intervals [from, to] of arc length to draw from; disjoint and in order. Initially the whole path is
  /// active.
  void activate(std::vector<std::pair<double, double>> stretches);
  /// As above, with one interval.
  void activate(double from, double to);
  void sample(Stream& stream, MutableView out);
  [[nodiscard]] double density(View q) const { return density_->at(q); }
  /// The density of the active intervals.
  [[nodiscard]] const std::shared_ptr<const Density>& density() const { return density_; }

  [[nodiscard]] double length() const { return tube_->length(); }
  [[nodiscard]] double radius() const { return tube_->ball().radius(); }
  [[nodiscard]] const Configurations& path() const { return tube_->path(); }
  /// The point of the path at arc length s.
  void point(double s, MutableView out) const { tube_->point(s, out); }

 private:
  std::shared_ptr<const Tube> tube_;
  std::vector<std::pair<double, double>> active_;
  double active_length_ = 0.0;
  std::shared_ptr<const Density> density_;
  Configuration centre_;  ///< scratch, to avoid allocation in `sample`
};

}  // namespace trellis
