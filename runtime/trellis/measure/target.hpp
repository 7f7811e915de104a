// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

namespace measure {
class PointTree;
class Tube;
}  // namespace measure

/// The tube target: T uniform on A = { x in C_free : d(x, P) < delta }, P the final path.
struct TubeSettings {
  double delta = 0.5;               ///< radius of the tube, metres
  std::string distance = "planar";  ///< "planar": the reference point's position only; "full": the space's metric
  std::string support = "free";     ///< "free": A holds valid configurations only; "all": the whole tube
  double epsilon = 0.05;            ///< uniform share mixed into Q for the defended value
  std::int64_t points = 4096;       ///< evaluation points on A
  std::int64_t pool = 16384;        ///< points of A for the volumes of cut balls
};
const Settings<TubeSettings>& tube_settings();

/// A target distribution T, uniform on a set A, with everything that scoring samples against it needs: |A|, quasi Monte
/// Carlo points of A, and membership. Immutable once made; may be shared between threads where `valid` may.
class Target {
 public:
  using Valid = std::function<bool(View)>;

  /// \param space     the space that the path lies in
  /// \param path      P, at least one configuration (one point gives a ball)
  /// \param position  axes of the reference point's position, for the planar distance; empty: the full metric
  /// \param valid     validity in the space; not counted in any level's checks
  /// \param seed      of the quasi Monte Carlo shift
  ///
  /// Calls `valid` for points of the tube only, about pool / free share times and at most 16 pool times. Throws Error
  /// for settings out of range, a path outside the space, an empty path; a tube without any valid configuration makes
  /// an empty target (log_volume = -inf), which scores nothing.
  Target(const Space& space, const Configurations& path, std::vector<std::size_t> position,
         const TubeSettings& settings, const Valid& valid, std::uint64_t seed);

  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] const TubeSettings& settings() const { return settings_; }
  [[nodiscard]] bool empty() const { return pool_.empty(); }
  /// log|A| in metric coordinates.
  [[nodiscard]] double log_volume() const { return log_volume_; }
  /// uniform = log|C| - log|A|: the divergence of uniform sampling, the zero of the scale, in nats.
  [[nodiscard]] double uniform() const { return space_.log_volume() - log_volume_; }
  /// |A| over the volume of the whole tube within C, in [0, 1].
  [[nodiscard]] double free_share() const { return free_share_; }
  /// Whether x lies in A (geometry and, for "free" support, validity).
  [[nodiscard]] bool contains(View x) const;
  /// Validity of x, whatever the support; true where the target was made without a validity.
  [[nodiscard]] bool valid(View x) const { return !valid_ || valid_(x); }
  /// The distance from x to P in the target's sense (planar or full). P is thinned: waypoints within delta / 1000 of
  /// the line that replaces them are left out.
  [[nodiscard]] double distance(View x) const;
  /// Points at which log q is averaged: a prefix of the pool.
  [[nodiscard]] std::size_t evaluation_points() const;
  [[nodiscard]] const Configurations& pool() const { return pool_; }
  /// The pool in metric coordinates, for counting points in balls; empty for an empty target.
  [[nodiscard]] const measure::PointTree& pool_tree() const { return *pool_tree_; }

 private:
  Space space_;
  std::shared_ptr<const measure::Tube> tube_;
  TubeSettings settings_;
  Valid valid_;
  double log_volume_ = 0.0;
  double free_share_ = 0.0;
  Configurations pool_;
  std::shared_ptr<const measure::PointTree> pool_tree_;
};

}  // namespace trellis
