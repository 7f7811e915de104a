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
#include <trellis/instance/instance.hpp>
#include <trellis/planner/nearest.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// Balls of one radius that a space is without.
class ExcludedBalls {
 public:
  /// \param radius  metres in the metric, >= 0
  ExcludedBalls(Space space, double radius);

  void add(View centre);
  void clear();
  [[nodiscard]] bool contains(View q) const;
  /// How far q lies inside the ball whose centre is nearest to it; 0 outside of all balls.
  [[nodiscard]] double depth(View q) const;
  /// Where on the motion from a to b, in [0, 1], it comes nearest to the first ball that it enters; none where it
  /// enters none.
  [[nodiscard]] std::optional<double> entered(View a, View b);
  /// How many centres are within the radius of q.
  [[nodiscard]] std::size_t count(View q);
  [[nodiscard]] double radius() const { return radius_; }

 private:
  Space space_;
  double radius_;
  NearestIndex index_;
  Configurations centres_;
  std::vector<NearestIndex::Neighbour> found_;
};

/// Places: each holds every configuration whose position is near that of one given, or, without a position, what is
/// near the configuration.
class Places {
 public:
  /// \param position_axes  the axes of the reference point's position; none: places are configurations
  /// \param radius         metres in the metric, of a place
  Places(const Space& space, std::vector<std::size_t> position_axes, double radius);

  void add(View q);
  void clear();
  [[nodiscard]] bool contains(View q);
  /// How many of the configurations given are near q.
  [[nodiscard]] std::size_t count(View q);
  /// Where on the motion from a to b, in [0, 1], it comes nearest to the first place that it enters; none where it
  /// enters none.
  [[nodiscard]] std::optional<double> entered(View a, View b);
  /// Whether the place about one of them would hold the other.
  [[nodiscard]] bool near(View a, View b);
  /// The configurations, as they were given.
  [[nodiscard]] const Configurations& given() const { return given_; }

 private:
  void project(View q, Configuration& position) const;

  std::vector<std::size_t> axes_;
  Space space_;  ///< of positions
  ExcludedBalls balls_;
  Configurations given_;
  Configuration a_;  ///< scratch
  Configuration b_;
};

/// A validity without some balls: paths that a search for another one is kept out of for a while, and places that were
/// refuted.
class ExcludingValidity final : public EvaluatedValidity {
 public:
  /// \param radius          metres in the metric, of the balls about a path
  /// \param position_axes   the axes of the reference point's position; none: places are configurations
  /// \param place_radius    metres in the metric, of the balls about a place's position, or about the place
  ExcludingValidity(std::shared_ptr<Validity> inner, const Space& space, double radius,
                    std::vector<std::size_t> position_axes = {}, double place_radius = 0.0);

  /// Excludes what is within the radius of the path, but for what is within twice the radius of its ends.
  void exclude(const Configurations& path);
  /// Points of a path half the radius apart, without those within twice the radius of its ends, that are chosen.
  [[nodiscard]] Configurations points_along(const Configurations& path, const std::function<bool(View)>& chosen) const;
  /// Excludes what is within the radius of any of the points, until `include_paths`.
  void exclude_points(const Configurations& points);
  /// Ends the exclusion of all paths.
  void include_paths();
  /// Excludes a place: every configuration whose position is near that of q, or without a position what is near q.
  /// \return false, and nothing is excluded, where it would hold one of the configurations to keep
  bool exclude_place(View q, const std::vector<Configuration>& keep);
  /// Takes the place of another one, of a world that has changed since: excludes the places that it excludes, and
  /// checks motions that were valid there anew.
  void replace(const ExcludingValidity& other);
  /// Whether a place excluded holds q.
  [[nodiscard]] bool in_place(View q) { return places_.contains(q); }
  /// The places, as they were given.
  [[nodiscard]] const Configurations& excluded_places() const { return places_.given(); }

  [[nodiscard]] bool state(View q) override { return !balls_.contains(q) && !in_place(q) && inner_->state(q); }
  [[nodiscard]] bool needed(View q) override { return !balls_.contains(q) && !in_place(q) && inner_->needed(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override;
  /// Only what was excluded can have become invalid, unless the validity inside changes too.
  [[nodiscard]] MotionReport motion_still_valid(View a, View b) override;
  [[nodiscard]] double clearance(View q) override { return inner_->clearance(q); }
  [[nodiscard]] bool spends_checks() const override { return inner_->spends_checks(); }
  [[nodiscard]] double effort_factor(View a, View b) const override { return inner_->effort_factor(a, b); }
  [[nodiscard]] std::optional<Contact> contact(View q) override { return inner_->contact(q); }
  [[nodiscard]] double invalid_radius(View q) override { return std::max(balls_.depth(q), inner_->invalid_radius(q)); }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_ + inner_->epoch(); }
  [[nodiscard]] std::optional<double> excluded(View a, View b) override {
    const auto at = entered(a, b);
    return at ? at : inner_->excluded(a, b);
  }
  void expect_guided(bool guided) override { inner_->expect_guided(guided); }
  [[nodiscard]] EdgeEvaluator* evaluator() override {
    auto* evaluated = dynamic_cast<EvaluatedValidity*>(inner_.get());
    return evaluated != nullptr ? evaluated->evaluator() : nullptr;
  }

 private:
  [[nodiscard]] std::optional<double> entered(View a, View b);

  std::shared_ptr<Validity> inner_;
  Space space_;
  ExcludedBalls balls_;
  Places places_;
  std::uint64_t inner_epoch_;  ///< when this was made
  bool replaces_ = false;      ///< motions that were valid may have been so in another world
  std::uint64_t epoch_ = 0;
};

}  // namespace trellis
