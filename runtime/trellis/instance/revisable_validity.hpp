// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <trellis/instance/forwarding_validity.hpp>

namespace trellis {

/// The validity of the root, which is revised after a path that it found valid was refuted. All that holds it, as the
/// spaces of guides do, then asks the revised one.
class RevisableValidity final : public ForwardingValidity<> {
 public:
  explicit RevisableValidity(std::shared_ptr<Validity> original)
      : ForwardingValidity(original), original_(std::move(original)) {}

  [[nodiscard]] const std::shared_ptr<Validity>& current() const { return inner_; }
  /// Excludes something more (Validity::enters_excluded). The epoch remains: what motions the root has to check again,
  /// its instance says.
  void exclude(std::shared_ptr<Validity> excluding) { inner_ = std::move(excluding); }
  /// Replaces the validity by a stricter one: nothing that was valid before is known to be valid still.
  void replace(std::shared_ptr<Validity> stricter) {
    ++replacements_;
    inner_ = std::move(stricter);
  }

  [[nodiscard]] bool state(View q) override { return inner_->state(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override { return inner_->motion(a, b); }
  void announce(View a, View b, const MotionReport& report) override { inner_->announce(a, b, report); }
  void certify(View a, View b, Certificate& certificate) override { inner_->certify(a, b, certificate); }
  /// A path of another space may pass what is excluded: the root goes around it.
  [[nodiscard]] bool needed(View q) override { return original_->needed(q); }
  [[nodiscard]] std::uint64_t epoch() const override { return replacements_ + original_->epoch(); }
  [[nodiscard]] MotionReport motion_still_valid(View a, View b, std::uint64_t since) override {
    return inner_->motion_still_valid(a, b, inner_ == original_ ? since : 0);
  }
  [[nodiscard]] std::optional<double> excluded(View a, View b) override { return original_->excluded(a, b); }
  [[nodiscard]] bool enters_excluded(View a, View b) override { return inner_->enters_excluded(a, b); }
  [[nodiscard]] std::shared_ptr<Validity> for_thread() const override { return inner_->for_thread(); }

 private:
  std::shared_ptr<Validity> original_;
  std::uint64_t replacements_ = 0;
};

}  // namespace trellis
