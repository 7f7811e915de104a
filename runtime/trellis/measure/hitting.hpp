// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <trellis/space/nearest.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// How often samples hit the balls along a path in turn, beside uniform samples of C. NaN where there is nothing to
/// score.
struct BallHits {
  /// log sum(1/u_i) - log sum(1/q_i), nats: the log ratio of the expected numbers of samples that hit the balls in
  /// turn, of uniform samples to these. u_i is the share of C in ball i, and q_i = (c_i + 1) / (N + 1/u_i) that of the
  /// samples, with c_i of N in the ball. 0: as uniform sampling; more is better.
  double hitting = std::numeric_limits<double>::quiet_NaN();
  /// Student's 95 % interval over runs, which scoring of several runs sets.
  double hitting_lo = std::numeric_limits<double>::quiet_NaN();
  double hitting_hi = std::numeric_limits<double>::quiet_NaN();
  /// min log(q_i / u_i), nats, the place where samples are rarest beside uniform ones; and its arc length along the
  /// path, metres.
  double bottleneck = std::numeric_limits<double>::quiet_NaN();
  double at = std::numeric_limits<double>::quiet_NaN();
  /// The simultaneous 95 % interval of the bottleneck for independent samples, by that of Clopper and Pearson for each
  /// of the J balls (0.025 / J at an end). -infinity where a ball has no sample.
  double bottleneck_lo = std::numeric_limits<double>::quiet_NaN();
  double bottleneck_hi = std::numeric_limits<double>::quiet_NaN();
};

/// The same in two metrics.
struct Hitting {
  /// By the position of the reference point, balls of radius delta; in the metric of C where the space has no position.
  BallHits position;
  /// In the metric of C, balls of radius 0.7 delta: by position a wrong heading scores as a right one.
  BallHits full;
  double length = std::numeric_limits<double>::quiet_NaN();   ///< of the path, as `position` measures it
  double samples = std::numeric_limits<double>::quiet_NaN();  ///< N, without those at the goal
};

namespace measure {

/// Balls along a path in a space, or in the part of it that some coordinates are. Immutable; threads may share it.
class Balls {
 public:
  /// \param space    that contains the path
  /// \param path     at least one configuration
  /// \param columns  the coordinates of the distance, at least one; empty: all
  /// \param radius   > 0, metres of the metric; the balls are at most half of it apart along the path
  Balls(const Space& space, const Configurations& path, const std::vector<std::size_t>& columns, double radius);

  [[nodiscard]] std::size_t size() const { return arcs_.size(); }
  [[nodiscard]] double length() const { return length_; }
  /// Returns the arc length at the centre of a ball.
  [[nodiscard]] double arc(std::size_t i) const { return arcs_[i]; }
  /// Returns log u, u the share of C in a ball.
  [[nodiscard]] double log_share(std::size_t i) const { return log_shares_[i]; }
  /// Adds 1 to the count of each ball that has the sample, a configuration of the space.
  void count(View sample, std::span<std::size_t> counts) const;

  /// Returns the values that follow from counts of so many samples.
  /// \param interval  whether to compute that of the bottleneck
  [[nodiscard]] BallHits hits(std::span<const std::size_t> counts, std::size_t samples, bool interval) const;

 private:
  Space part_;
  std::vector<std::size_t> columns_;  // empty: all
  double radius_;
  double length_ = 0.0;
  std::vector<double> arcs_;
  std::vector<double> log_shares_;
  NearestIndex centres_;
};

}  // namespace measure

/// The balls along a path in both metrics.
class PathBalls {
 public:
  /// \param space     that contains the path
  /// \param path      at least one configuration
  /// \param position  the coordinates of the reference point's position; empty: none
  /// \param delta     > 0, metres of the metric
  PathBalls(const Space& space, const Configurations& path, const std::vector<std::size_t>& position, double delta);

  /// Scores samples. Samples at `goal` itself do not count: a planner proposes it whatever its guide.
  /// \param samples   configurations of the space; those outside of it count in N and hit nothing
  /// \param goal      a configuration; empty: none
  /// \param interval  whether to compute the interval of the bottleneck
  [[nodiscard]] Hitting hitting(const Configurations& samples, View goal, bool interval = true) const;

  [[nodiscard]] const measure::Balls& position() const { return position_; }
  [[nodiscard]] const measure::Balls& full() const { return full_; }

 private:
  Space space_;
  measure::Balls position_;
  measure::Balls full_;
};

/// The radius of the balls in the metric of C, as a share of that by position.
inline constexpr double full_radius = 0.7;

/// Returns the mean over several paths, with the bottleneck and the length of the first: places on two paths differ.
/// The samples are those of the path with the fewest.
Hitting mean(std::span<const Hitting> hits);

}  // namespace trellis
