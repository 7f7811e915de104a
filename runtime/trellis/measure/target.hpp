// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/base/random.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

class NearestIndex;

namespace measure {
struct TargetFeature;
class Tube;
}  // namespace measure

/// The options of all targets.
struct TargetSettings {
  double delta = 0.5;          ///< radius of the tube, and of the balls of coverage; metres of the metric
  std::int64_t points = 2048;  ///< evaluation points on the target
  std::int64_t pool = 8192;    ///< points of the target for the volumes of intersected balls and for `exact`
};

/// The tube target: T uniform on A = { x in C_free : d(x, P) < delta }, P the final path.
struct TubeSettings : TargetSettings {
  enum class Distance {
    planar,  ///< the reference point's position only
    full     ///< the space's metric
  };
  enum class Support {
    free,  ///< A contains valid configurations only
    all    ///< the whole tube
  };
  Distance distance = Distance::planar;
  Support support = Support::free;
};
/// The words of scripts and results.
std::string to_string(TubeSettings::Distance distance);
std::string to_string(TubeSettings::Support support);
const Settings<TubeSettings>& tube_settings();

/// The target of near-optimal paths: T uniform on the configurations that lie on a path of at most (1 + epsilon) times
/// the optimal length.
struct NearOptimalSettings : TargetSettings {
  double epsilon = 0.1;       ///< excess length relative to the optimum
  std::int64_t nodes = 8000;  ///< of the PRM* that provides the costs
};
const Settings<NearOptimalSettings>& near_optimal_settings();

/// The target of motions that make progress: T uniform over the controls that move the robot closer to the goal.
struct ProgressSettings : TargetSettings {
  ProgressSettings() { delta = 0.05; }
  double step = 0.5;            ///< length of a straight motion, metres of the metric
  std::int64_t controls = 256;  ///< motions to rank each one among
};
const Settings<ProgressSettings>& progress_settings();

/// A target distribution T with the data for scoring samples: quasi Monte Carlo points of it, its density there, and
/// its support A. Uniform on A unless constructed from a distribution. Immutable; threads may share it where its
/// functions are thread-safe.
class Target {
 public:
  using Valid = std::function<bool(View)>;

  /// The tube about a path.
  /// \param space     the space that contains the path
  /// \param path      P, at least two configurations, not all the same position
  /// \param position  axes of the reference point's position, for the planar distance; empty: the full metric
  /// \param valid     validity in the space; no level counts these checks
  /// \param seed      of the quasi Monte Carlo shift
  ///
  /// Calls `valid` for points of the tube only, about pool / free share times and at most 16 pool times. A tube without
  /// any valid configuration gives an empty target (log_volume = -inf), which scores nothing.
  /// \throws Error for settings out of range, a path outside the space, an empty path or one without length.
  Target(const Space& space, const Configurations& path, std::vector<std::size_t> position,
         const TubeSettings& settings, const Valid& valid, std::uint64_t seed);

  /// Returns T uniform on { x in C : contains(x) }, by rejection sampling of the whole space: at most 64 pool calls.
  /// Empty where no sample is accepted.
  static Target region(const Space& space, const TargetSettings& settings, const Valid& contains, std::uint64_t seed);

  /// A distribution that the user defines.
  struct Distribution {
    /// Independent draws, `pool` of them, within the space.
    Configurations samples;
    /// log T with respect to volume in metric coordinates, or of the metric where the space has rotations; -inf outside
    /// of the support.
    std::function<double(View)> log_density;
  };
  /// \throws Error for draws outside of the space, fewer than 64 of them, and densities that are NaN or, at a draw, not
  ///     finite.
  static Target distribution(const Space& space, const TargetSettings& settings, const Distribution& distribution);

  [[nodiscard]] const Space& space() const { return space_; }
  /// Returns the radius of the balls of coverage (a tube's own radius).
  [[nodiscard]] double delta() const { return settings_.delta; }
  [[nodiscard]] bool empty() const { return pool_.empty(); }
  /// Whether T is uniform on A.
  [[nodiscard]] bool is_uniform() const { return log_weights_.empty(); }
  /// Returns log|A|, in metric coordinates where the space is flat; NaN where T is not uniform.
  [[nodiscard]] double log_volume() const { return log_volume_; }
  /// Returns a standard error of `log_volume`: that of as many independent draws. Its draws have low discrepancy, so
  /// the error is smaller, the more so the fewer dimensions the space has.
  [[nodiscard]] double log_volume_error() const { return log_volume_error_; }
  /// Returns log T at a point of the pool.
  [[nodiscard]] double log_density(std::size_t i) const { return is_uniform() ? -log_volume_ : log_weights_[i]; }
  /// Returns D(T || uniform on C), which is log|C| - log|A| where T is uniform: the divergence of uniform sampling, the
  /// zero of the scale, in nats.
  [[nodiscard]] double uniform() const { return uniform_; }
  /// Returns |A| over the volume of the whole tube within C, in [0, 1]; 1 where the target is no tube.
  [[nodiscard]] double free_share() const { return free_share_; }
  /// Whether x lies in A (geometry and, for "free" support, validity).
  [[nodiscard]] bool contains(View x) const;
  /// Whether A contains invalid configurations too.
  [[nodiscard]] bool holds_invalid() const { return holds_invalid_; }
  /// Whether x is valid, whatever the support; true where the target has no validity.
  [[nodiscard]] bool valid(View x) const { return !valid_ || valid_(x); }

  /// Whether the target is a tube, which has a path.
  [[nodiscard]] bool has_path() const { return tube_ != nullptr; }
  /// Returns the distance from x to P in the target's metric (planar or full). P is simplified: waypoints within delta
  /// / 1000 of the line that replaces them are omitted.
  [[nodiscard]] double distance(View x) const;
  /// Returns the same at a row, as those of `pool_rows`.
  [[nodiscard]] double distance_at_row(View y) const;
  /// Returns the length of P in the target's metric, and the arc length at the point of P nearest to x.
  [[nodiscard]] double length() const;
  [[nodiscard]] double along(View x) const;
  /// Returns the axes of the distance.
  [[nodiscard]] const std::vector<std::size_t>& axes() const;

  /// Returns independent draws from T, other points than the evaluation points at the pool's beginning: the proposals
  /// of perfect guidance. Fewer than `count` where samples of the target are rare, or the target has too few draws.
  [[nodiscard]] Configurations draw(std::size_t count, Stream& stream) const;

  /// Returns the number of points over which log q is averaged: a prefix of the pool.
  [[nodiscard]] std::size_t evaluation_points() const;
  [[nodiscard]] const Configurations& pool() const { return pool_; }
  /// Returns the pool row by row: in metric coordinates where the space is flat.
  [[nodiscard]] const std::vector<double>& pool_rows() const { return pool_rows_; }
  /// Returns a tree, for counting points in balls, of about the first `points` points of the pool: 2/3 to 4/3 of them,
  /// at least 1024; the whole pool if that is at most twice as many. The target builds each tree once. Thread-safe.
  [[nodiscard]] const NearestIndex& pool_tree(std::size_t points) const;
  /// Returns functions of the configurations at the first points of the pool: of a tube, arc length and distance from
  /// the path; in a flat space, each axis; then the squared distances to the last points of the pool. The target
  /// computes them once. Thread-safe.
  [[nodiscard]] const std::vector<measure::TargetFeature>& features() const;
  /// Returns the probability that one uniform sample falls within delta of an evaluation point, and the log of the
  /// probability that it does not.
  [[nodiscard]] double hit(std::size_t i) const { return hits_[i]; }
  [[nodiscard]] double log_miss(std::size_t i) const { return log_misses_[i]; }
  /// Returns the arc length at an evaluation point, of a target that has a path.
  [[nodiscard]] double arc(std::size_t i) const { return arcs_[i]; }

 private:
  Target(const Space& space, const TargetSettings& settings);
  /// Computes all results that depend on the pool.
  void finish();

  Space space_;
  TargetSettings settings_;
  std::shared_ptr<const measure::Tube> tube_;
  Valid valid_;
  std::function<bool(View)> contains_;  // of regions and distributions
  bool holds_invalid_ = false;
  double log_volume_ = std::numeric_limits<double>::quiet_NaN();
  double log_volume_error_ = std::numeric_limits<double>::quiet_NaN();
  double uniform_ = std::numeric_limits<double>::quiet_NaN();
  double free_share_ = 1.0;
  Configurations pool_;
  std::vector<double> log_weights_;  // log T at the pool; empty where T is uniform
  std::vector<double> pool_rows_;
  std::vector<double> hits_, log_misses_;
  std::vector<double> arcs_;  // of tubes
  struct PoolTrees;
  std::shared_ptr<PoolTrees> pool_trees_;
};

}  // namespace trellis
