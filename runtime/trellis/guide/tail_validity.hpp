// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// Validity of the coordinates from one on.
class TailValidity final : public Validity {
 public:
  TailValidity(std::shared_ptr<Validity> tail, std::size_t first) : tail_(std::move(tail)), first_(first) {}
  [[nodiscard]] bool state(View s) override { return tail_->state(s.subspan(first_)); }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    return tail_->motion(a.subspan(first_), b.subspan(first_));
  }
  void certify(View a, View b, Certificate& certificate) override {
    tail_->certify(a.subspan(first_), b.subspan(first_), certificate);
  }
  [[nodiscard]] const CheckCost& cost() const override { return tail_->cost(); }
  [[nodiscard]] double clearance(View s) override { return tail_->clearance(s.subspan(first_)); }
  [[nodiscard]] std::optional<Contact> contact(View s) override { return tail_->contact(s.subspan(first_)); }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View s) override {
    return tail_->nearest_obstacle(s.subspan(first_));
  }

 private:
  std::shared_ptr<Validity> tail_;
  std::size_t first_;
};

}  // namespace trellis
