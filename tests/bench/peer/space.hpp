// SPDX-License-Identifier: GPL-3.0-or-later
// SE(2) of OMPL with the metric of Trellis.
#pragma once

#include <ompl/base/spaces/SE2StateSpace.h>

#include <cmath>
#include <numbers>

namespace bench {

/// SE(2) with the metric of Trellis: the root of the sum of squares, half a turn as long as a metre.
class Space final : public ompl::base::SE2StateSpace {
 public:
  [[nodiscard]] double distance(const ompl::base::State* a, const ompl::base::State* b) const override {
    const auto* p = a->as<StateType>();
    const auto* q = b->as<StateType>();
    double turn = std::abs(p->getYaw() - q->getYaw());
    if (turn > std::numbers::pi) turn = 2.0 * std::numbers::pi - turn;
    return std::hypot(p->getX() - q->getX(), p->getY() - q->getY(), turn / std::numbers::pi);
  }
};

}  // namespace bench
