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
#include <trellis/space/space.hpp>

namespace trellis {

// Distributions with closed densities, from which heuristics are made. Densities are with respect to volume in metric
// coordinates. What falls beyond a wall is reflected back into the space, so every density integrates to 1 over it.

/// The largest radius not above `wanted` at which balls of the space meet neither themselves round a periodic axis nor
/// two opposite walls at once.
double fitting_radius(const Space& space, double wanted);

/// Uniform on the metric ball about a centre.
class BallKernel {
 public:
  /// \param radius  metres, > 0; shortened by fitting_radius
  BallKernel(Space space, double radius);
  void sample(View centre, Stream& stream, MutableView out) const;
  [[nodiscard]] double density(View centre, View q) const;
  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] double log_volume() const { return log_volume_; }
  [[nodiscard]] const Space& space() const { return space_; }

 private:
  Space space_;
  double radius_;
  double log_volume_;
};

/// A path and the balls about its points. Shared by all densities that were ever drawn from it.
class Tube {
 public:
  /// \param path    at least one configuration of the space
  /// \param radius  metres, > 0; shortened by fitting_radius
  Tube(const Space& space, Configurations path, double radius);

  [[nodiscard]] double length() const { return at_.back(); }
  [[nodiscard]] const BallKernel& ball() const { return ball_; }
  [[nodiscard]] const Configurations& path() const { return path_; }
  /// Arc length up to each point of the path.
  [[nodiscard]] const std::vector<double>& at() const { return at_; }
  /// The point of the path at arc length s.
  void point(double s, MutableView out) const;

 private:
  BallKernel ball_;
  Configurations path_;
  std::vector<double> at_;
};

/// A mixture of balls of one radius about points of tubes, uniform in arc length over stretches of them. Whatever the
/// number of tubes and stretches, it is evaluated at the few legs near a configuration, found in a tree of boxes.
class TubeDensity final : public Density {
 public:
  struct Stretch {
    double from = 0.0;  ///< arc length
    double to = 0.0;    ///< not below `from`; equal: the point itself
    double mass = 0.0;
  };
  struct Part {
    std::shared_ptr<const Tube> tube;
    std::vector<Stretch> stretches;  ///< no two share more than a point
  };

  /// \param parts  at least one; all of one space and radius
  explicit TubeDensity(std::vector<Part> parts);

  [[nodiscard]] double at(View q) const override;
  /// Balls of one radius in one space.
  [[nodiscard]] bool akin(const Density& other) const override;
  /// The weights of what was drawn from the same tube are added up, stretch by stretch.
  [[nodiscard]] std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const override;

 private:
  /// A straight piece from p to p + v in metric coordinates, unwrapped. Its numbers lie in `numbers_`: p, v.
  struct Leg {
    double length = 0.0;
    double rate = 0.0;  ///< mass per metre; the mass itself where the length is 0
  };
  struct Node {
    std::uint32_t begin = 0;  ///< legs
    std::uint32_t end = 0;
    std::uint32_t right = 0;  ///< the second child, the first comes next; 0: a leaf
  };

  /// Makes what `at` looks up. Most densities of a run are never evaluated, only summed.
  void index() const;
  void add_legs(const Part& part) const;
  std::uint32_t build(std::vector<std::uint32_t>& order, std::uint32_t begin, std::uint32_t end) const;
  /// The mass of ball centres within the radius of y, an image of a configuration in metric coordinates.
  [[nodiscard]] double mass_near(const double* y) const;
  [[nodiscard]] double mass_near(const Leg& leg, const double* numbers, const double* y) const;

  std::vector<Part> parts_;
  const Space& space_;
  double radius_;
  double height_;  ///< of the density of one ball
  mutable std::once_flag indexed_;
  mutable std::vector<Leg> legs_;
  mutable std::vector<double> numbers_;
  mutable std::vector<Node> nodes_;
  mutable std::vector<double> boxes_;  ///< per node: the lower corner, then the upper
};

/// The tube about a path: a point of the path uniform in arc length over the active stretches, then uniform on the ball
/// about it.
class TubeKernel {
 public:
  TubeKernel(const Space& space, Configurations path, double radius);

  /// The stretches [from, to] of arc length to draw from, disjoint and in order; the whole path at first.
  void activate(std::vector<std::pair<double, double>> stretches);
  void sample(Stream& stream, MutableView out);
  [[nodiscard]] double density(View q) const { return density_->at(q); }
  /// The density of the stretches that are active now.
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
  Configuration centre_;  ///< scratch, so that drawing allocates nothing
};

}  // namespace trellis
