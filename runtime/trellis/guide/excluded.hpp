// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/instance/edge_evaluator.hpp>
#include <trellis/instance/forwarding_validity.hpp>
#include <trellis/space/nearest.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// A union of balls of equal radius that a space excludes.
class ExcludedBalls {
 public:
  /// \param radius  metres in the metric, >= 0
  ExcludedBalls(Space space, double radius);

  void add(View centre);
  void clear();
  [[nodiscard]] bool contains(View q) const;
  /// Distance from q to the surface of the ball with the nearest centre if q is inside, in metres in the metric; else
  /// 0.
  [[nodiscard]] double depth(View q) const;
  /// The position on the motion from a to b, in [0, 1], at which it is nearest to the centre of the first-added ball
  /// that it enters; none if it enters no ball.
  /// \param first  only balls from that one on, counted from 0 in the order in which they were added
  [[nodiscard]] std::optional<double> entered(View a, View b, std::size_t first = 0);
  [[nodiscard]] std::size_t size() const { return index_.size(); }
  /// The number of centres within the radius of q.
  [[nodiscard]] std::size_t count(View q);
  [[nodiscard]] double radius() const { return radius_; }

 private:
  /// Whether the coordinates on lines alone keep the motion from a to b farther from a centre than the radius.
  [[nodiscard]] bool lines_apart(View a, View b, View centre) const;

  Space space_;
  double radius_;
  NearestIndex index_;
  Configurations centres_;
  std::vector<NearestIndex::Neighbour> found_;
};

/// A set of excluded places. A place contains all configurations whose position is near that of a given configuration;
/// in a space without position axes, all configurations near the given one.
class Places {
 public:
  /// \param position_axes  axes of the reference point's position; empty: places are balls of configurations
  /// \param radius  of a place, in metres in the metric
  Places(const Space& space, std::vector<std::size_t> position_axes, double radius);

  void add(View q);
  void clear();
  [[nodiscard]] bool contains(View q);
  /// The number of added configurations near q.
  [[nodiscard]] std::size_t count(View q);
  /// The position on the motion from a to b, in [0, 1], at which it is nearest to the first-added place that it enters;
  /// none if it enters no place.
  [[nodiscard]] std::optional<double> entered(View a, View b);
  /// Whether the place about either configuration would contain the other.
  [[nodiscard]] bool near(View a, View b);
  /// The added configurations.
  [[nodiscard]] const Configurations& given() const { return given_; }

 private:
  void project(View q, Configuration& position) const;

  std::vector<std::size_t> axes_;
  Space space_;  ///< the space of positions
  ExcludedBalls balls_;
  Configurations given_;
  Configuration a_;  ///< scratch
  Configuration b_;
};

/// A validity that excludes balls: about earlier paths, while a search looks for a distinct one, and about refuted
/// places.
class ExcludingValidity final : public ForwardingValidity<EvaluatedValidity> {
 public:
  /// \param radius  of the balls about a path, in metres in the metric
  /// \param position_axes  axes of the reference point's position; empty: places are balls of configurations
  /// \param place_radius  of a place, in metres in the metric
  ExcludingValidity(std::shared_ptr<Validity> inner, const Space& space, double radius,
                    std::vector<std::size_t> position_axes = {}, double place_radius = 0.0);

  /// Excludes the configurations within the radius of the path, except those within twice the radius of its ends.
  void exclude(const Configurations& path);
  /// Points of a path at distances of half the radius for which `chosen` returns true, without those within twice the
  /// radius of its ends.
  [[nodiscard]] Configurations points_along(const Configurations& path, const std::function<bool(View)>& chosen) const;
  /// Excludes the configurations within the radius of any of the points, until `include_paths`.
  void exclude_points(const Configurations& points);
  /// Ends the exclusion of all paths and points.
  void include_paths();
  /// Excludes a place: all configurations whose position is near that of q; without position axes, those near q.
  /// \return false, without exclusion, if the place contains a configuration of `keep`
  bool exclude_place(View q, const std::vector<Configuration>& keep);
  /// Replaces the validity of a world that has changed since: excludes the same places, and rechecks motions that were
  /// valid in that world.
  void replace(const ExcludingValidity& other);
  /// Whether an excluded place contains q.
  [[nodiscard]] bool in_place(View q) { return places_.contains(q); }
  /// Whether the place about either configuration would contain the other.
  [[nodiscard]] bool same_place(View a, View b) { return places_.near(a, b); }
  /// The configurations of the excluded places.
  [[nodiscard]] const Configurations& excluded_places() const { return places_.given(); }

  [[nodiscard]] bool state(View q) override { return !balls_.contains(q) && !in_place(q) && inner_->state(q); }
  [[nodiscard]] bool needed(View q) override { return !balls_.contains(q) && !in_place(q) && inner_->needed(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override;
  /// Only exclusions can have made the motion invalid, unless the inner validity changed too.
  [[nodiscard]] MotionReport motion_still_valid(View a, View b, std::uint64_t since) override;
  [[nodiscard]] double invalid_radius(View q) override { return std::max(balls_.depth(q), inner_->invalid_radius(q)); }
  [[nodiscard]] std::uint64_t epoch() const override { return changed_.size() + inner_->epoch(); }
  [[nodiscard]] std::optional<double> excluded(View a, View b) override {
    const auto at = entered(a, b);
    return at ? at : inner_->excluded(a, b);
  }
  [[nodiscard]] EdgeEvaluator* evaluator() override {
    auto* evaluated = dynamic_cast<EvaluatedValidity*>(inner_.get());
    return evaluated != nullptr ? evaluated->evaluator() : nullptr;
  }

 private:
  [[nodiscard]] std::optional<double> entered(View a, View b);
  /// Notes a change of the exclusions.
  void changed();

  Space space_;
  ExcludedBalls balls_;
  Places places_;
  std::uint64_t inner_epoch_;           ///< at construction
  bool replaces_ = false;               ///< motions may have been valid in another world
  std::vector<std::uint64_t> changed_;  ///< epochs with the inner validity's, after each change of the exclusions
};

}  // namespace trellis
