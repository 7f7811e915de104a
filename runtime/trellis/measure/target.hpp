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

namespace measure {
class PointTree;
class Tube;
}  // namespace measure

/// What every target has.
struct TargetSettings {
  double delta = 0.5;          ///< radius of the tube, and of the balls that coverage counts; metres of the metric
  std::int64_t points = 4096;  ///< evaluation points on the target
  std::int64_t pool = 16384;   ///< points of the target for the volumes of cut balls and for `exact`
};

/// The tube target: T uniform on A = { x in C_free : d(x, P) < delta }, P the final path.
struct TubeSettings : TargetSettings {
  std::string distance = "planar";  ///< "planar": the reference point's position only; "full": the space's metric
  std::string support = "free";     ///< "free": A holds valid configurations only; "all": the whole tube
};
const Settings<TubeSettings>& tube_settings();

/// The target of paths near the optimum: T uniform on the configurations that lie on a path of at most (1 + epsilon)
/// times the optimal length.
struct NearOptimalSettings : TargetSettings {
  double epsilon = 0.1;       ///< how much longer than the optimum
  std::int64_t nodes = 8000;  ///< of the PRM* that costs are taken from
};
const Settings<NearOptimalSettings>& near_optimal_settings();

/// The target of motions that make progress: T uniform over the controls that bring the robot closer to the goal.
struct ProgressSettings : TargetSettings {
  ProgressSettings() { delta = 0.05; }
  double step = 0.5;            ///< length of a motion, metres of the metric
  std::int64_t controls = 256;  ///< motions that each one is ranked among
};
const Settings<ProgressSettings>& progress_settings();

/// A target distribution T with everything that scoring samples against it needs: quasi Monte Carlo points of it, its
/// density there, and its support A. Uniform on A unless it was made from a distribution. Immutable once made; may be
/// shared between threads where its functions may.
class Target {
 public:
  using Valid = std::function<bool(View)>;

  /// The tube about a path.
  /// \param space     the space that the path lies in
  /// \param path      P, at least two configurations, not all the same position
  /// \param position  axes of the reference point's position, for the planar distance; empty: the full metric
  /// \param valid     validity in the space; not counted in any level's checks
  /// \param seed      of the quasi Monte Carlo shift
  ///
  /// Calls `valid` for points of the tube only, about pool / free share times and at most 16 pool times. Throws Error
  /// for settings out of range, a path outside the space, an empty path or one without length; a tube without any valid
  /// configuration makes an empty target (log_volume = -inf), which scores nothing.
  Target(const Space& space, const Configurations& path, std::vector<std::size_t> position,
         const TubeSettings& settings, const Valid& valid, std::uint64_t seed);

  /// T uniform on { x in C : contains(x) }, found by rejection from the whole space: at most 64 pool questions. Empty
  /// where none is found.
  static Target region(const Space& space, const TargetSettings& settings, const Valid& contains, std::uint64_t seed);

  /// A distribution of the user's.
  struct Distribution {
    /// Independent draws, `pool` of them, within the space.
    Configurations samples;
    /// log T with respect to volume in metric coordinates; -inf outside of the support.
    std::function<double(View)> log_density;
  };
  /// Throws Error for draws outside of the space, fewer than 64 of them, and densities that are NaN or, at a draw, not
  /// finite.
  static Target distribution(const Space& space, const TargetSettings& settings, const Distribution& distribution);

  [[nodiscard]] const Space& space() const { return space_; }
  /// The radius of the balls that coverage counts (a tube's own radius).
  [[nodiscard]] double delta() const { return settings_.delta; }
  [[nodiscard]] bool empty() const { return pool_.empty(); }
  /// Whether T is uniform on A.
  [[nodiscard]] bool is_uniform() const { return log_weights_.empty(); }
  /// log|A| in metric coordinates; NaN where T is not uniform.
  [[nodiscard]] double log_volume() const { return log_volume_; }
  /// log T at a point of the pool.
  [[nodiscard]] double log_density(std::size_t i) const { return is_uniform() ? -log_volume_ : log_weights_[i]; }
  /// uniform = D(T || uniform on C), log|C| - log|A| where T is uniform: the divergence of uniform sampling, the zero
  /// of the scale, in nats.
  [[nodiscard]] double uniform() const { return uniform_; }
  /// |A| over the volume of the whole tube within C, in [0, 1]; 1 where the target is no tube.
  [[nodiscard]] double free_share() const { return free_share_; }
  /// Whether x lies in A (geometry and, for "free" support, validity).
  [[nodiscard]] bool contains(View x) const;
  /// Whether A holds invalid configurations too.
  [[nodiscard]] bool holds_invalid() const { return holds_invalid_; }
  /// Validity of x, whatever the support; true where the target was made without a validity.
  [[nodiscard]] bool valid(View x) const { return !valid_ || valid_(x); }

  /// Whether the target is a tube, which has a path.
  [[nodiscard]] bool has_path() const { return tube_ != nullptr; }
  /// The distance from x to P in the target's sense (planar or full). P is thinned: waypoints within delta / 1000 of
  /// the line that replaces them are left out.
  [[nodiscard]] double distance(View x) const;
  /// Length of P in the target's sense, and the arc length at the point of P nearest to x.
  [[nodiscard]] double length() const;
  [[nodiscard]] double along(View x) const;
  /// The axes that the distance counts.
  [[nodiscard]] const std::vector<std::size_t>& axes() const;
  /// Points of the whole tube, valid or not: what `legacy` takes for the target.
  [[nodiscard]] const Configurations& whole_tube() const { return whole_tube_; }

  /// Independent draws from T, other points than those of the pool's beginning that log q is averaged at: what perfect
  /// guidance would propose. Fewer than asked for where the target is hardly found, or was made from too few draws.
  [[nodiscard]] Configurations draw(std::size_t count, Stream& stream) const;

  /// Points at which log q is averaged: a prefix of the pool.
  [[nodiscard]] std::size_t evaluation_points() const;
  [[nodiscard]] const Configurations& pool() const { return pool_; }
  /// The pool in metric coordinates, row by row, and its tree for counting points in balls.
  [[nodiscard]] const std::vector<double>& pool_rows() const { return pool_rows_; }
  [[nodiscard]] const measure::PointTree& pool_tree() const { return *pool_tree_; }
  /// The chance that one uniform sample falls within delta of an evaluation point, and the logs of the chances that it
  /// does not, nor within delta / 2.
  [[nodiscard]] double hit(std::size_t i) const { return hits_[i]; }
  [[nodiscard]] double log_miss(std::size_t i) const { return log_misses_[i]; }
  [[nodiscard]] double log_half_miss(std::size_t i) const { return log_half_misses_[i]; }
  /// Where along the path an evaluation point lies, of a target that has a path.
  [[nodiscard]] double arc(std::size_t i) const { return arcs_[i]; }

 private:
  Target(const Space& space, const TargetSettings& settings);
  /// Everything that follows from the pool.
  void finish();

  Space space_;
  TargetSettings settings_;
  std::shared_ptr<const measure::Tube> tube_;
  Valid valid_;
  std::function<bool(View)> contains_;  // of regions and distributions
  bool holds_invalid_ = false;
  double log_volume_ = std::numeric_limits<double>::quiet_NaN();
  double uniform_ = std::numeric_limits<double>::quiet_NaN();
  double free_share_ = 1.0;
  Configurations pool_;
  Configurations whole_tube_;
  std::vector<double> log_weights_;  // log T at the pool; empty where T is uniform
  std::vector<double> pool_rows_;
  std::vector<double> hits_, log_misses_, log_half_misses_;
  std::vector<double> arcs_;  // of tubes
  std::shared_ptr<const measure::PointTree> pool_tree_;
};

}  // namespace trellis
