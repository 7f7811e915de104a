// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <trellis/base/configurations.hpp>
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
  /// Where on the motion from a to b, in [0, 1], it comes nearest to the first ball that it enters; none where it
  /// enters none.
  [[nodiscard]] std::optional<double> entered(View a, View b);
  [[nodiscard]] double radius() const { return radius_; }

 private:
  Space space_;
  double radius_;
  NearestIndex index_;
  Configurations centres_;
  std::vector<NearestIndex::Neighbour> found_;
};

/// A validity without some balls for a while: what a search for a path distinct from others is kept out of.
class ExcludingValidity final : public Validity {
 public:
  ExcludingValidity(std::shared_ptr<Validity> inner, const Space& space, double radius)
      : inner_(std::move(inner)), space_(space), balls_(space, radius) {}

  /// Excludes what is within the radius of the path, but for what is within twice the radius of its ends.
  void exclude(const Configurations& path);
  void include_all();

  [[nodiscard]] bool state(View q) override { return !balls_.contains(q) && inner_->state(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override;
  [[nodiscard]] double clearance(View q) override { return inner_->clearance(q); }
  [[nodiscard]] bool spends_checks() const override { return inner_->spends_checks(); }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_ + inner_->epoch(); }

 private:
  std::shared_ptr<Validity> inner_;
  Space space_;
  ExcludedBalls balls_;
  std::uint64_t epoch_ = 0;
};

}  // namespace trellis
