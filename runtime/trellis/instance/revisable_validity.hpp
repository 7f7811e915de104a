// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// The validity of the root, which is revised after a path that it found valid was refuted. All that holds it, as the
/// spaces of guides do, then asks the revised one.
class RevisableValidity final : public Validity {
 public:
  explicit RevisableValidity(std::shared_ptr<Validity> original)
      : original_(std::move(original)), current_(original_) {}

  [[nodiscard]] const std::shared_ptr<Validity>& current() const { return current_; }
  /// Excludes something more (Validity::enters_excluded). The epoch remains: what motions the root has to check again,
  /// its instance says.
  void exclude(std::shared_ptr<Validity> excluding) { current_ = std::move(excluding); }
  /// Replaces the validity by a stricter one: nothing that was valid before is known to be valid still.
  void replace(std::shared_ptr<Validity> stricter) {
    ++replacements_;
    current_ = std::move(stricter);
  }

  [[nodiscard]] bool state(View q) override { return current_->state(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override { return current_->motion(a, b); }
  void announce(View a, View b, const MotionReport& report) override { current_->announce(a, b, report); }
  void certify(View a, View b, Certificate& certificate) override { current_->certify(a, b, certificate); }
  [[nodiscard]] double clearance(View q) override { return current_->clearance(q); }
  [[nodiscard]] const CheckCost& cost() const override { return current_->cost(); }
  [[nodiscard]] bool spends_checks() const override { return current_->spends_checks(); }
  /// A path of another space may pass what is excluded: the root goes around it.
  [[nodiscard]] bool needed(View q) override { return original_->needed(q); }
  [[nodiscard]] std::optional<Contact> contact(View q) override { return current_->contact(q); }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) override { return current_->nearest_obstacle(q); }
  [[nodiscard]] std::uint64_t epoch() const override { return replacements_ + original_->epoch(); }
  [[nodiscard]] MotionReport motion_still_valid(View a, View b, std::uint64_t since) override {
    return current_->motion_still_valid(a, b, current_ == original_ ? since : 0);
  }
  [[nodiscard]] double effort_factor(View a, View b) const override { return current_->effort_factor(a, b); }
  [[nodiscard]] std::optional<double> excluded(View a, View b) override { return original_->excluded(a, b); }
  [[nodiscard]] bool enters_excluded(View a, View b) override { return current_->enters_excluded(a, b); }
  [[nodiscard]] std::shared_ptr<Validity> for_thread() const override { return current_->for_thread(); }
  void expect_guided(bool guided) override { current_->expect_guided(guided); }
  [[nodiscard]] double invalid_radius(View q) override { return current_->invalid_radius(q); }

 private:
  std::shared_ptr<Validity> original_;
  std::shared_ptr<Validity> current_;
  std::uint64_t replacements_ = 0;
};

}  // namespace trellis
