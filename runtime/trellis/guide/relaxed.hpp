// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <unordered_set>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// Validity in a space S that relaxes C and has its coordinates: a motion that is valid in C is valid in S.
///
/// A motion towards a guided proposal is likely to become part of the path. Its validity is checked in C first: if
/// valid there, one check serves both spaces, and C need not check the path again. If too many of the last motions were
/// invalid in C, only some are checked in C first.
class RelaxedValidity final : public Validity {
 public:
  /// \param own  validity in S
  /// \param c  validity in C, by collision checks
  RelaxedValidity(std::shared_ptr<Validity> own, std::shared_ptr<Validity> c)
      : own_(std::move(own)), c_(std::move(c)), c_epoch_(c_->epoch()) {}

  [[nodiscard]] bool state(View q) override { return own_->state(q); }
  [[nodiscard]] bool needed(View q) override { return c_->needed(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override;
  /// Other threads check motions in S alone.
  void announce(View a, View b, const MotionReport& report) override { own_->announce(a, b, report); }
  /// The report counts the checks in both spaces.
  [[nodiscard]] MotionReport motion_still_valid(View a, View b, std::uint64_t since) override {
    return valid_in_c(a, b) ? MotionReport{true, 0, std::numeric_limits<double>::quiet_NaN()}
                            : own_->motion_still_valid(a, b, since);
  }
  [[nodiscard]] double clearance(View q) override { return own_->clearance(q); }
  [[nodiscard]] const CheckCost& cost() const override { return own_->cost(); }
  [[nodiscard]] bool spends_checks() const override { return own_->spends_checks(); }
  [[nodiscard]] std::shared_ptr<Validity> checking() const override { return trellis::checking(own_); }
  [[nodiscard]] std::optional<Contact> contact(View q) override { return own_->contact(q); }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) override { return own_->nearest_obstacle(q); }
  [[nodiscard]] std::uint64_t epoch() const override { return own_->epoch(); }
  [[nodiscard]] double effort_factor(View a, View b) const override { return own_->effort_factor(a, b); }
  [[nodiscard]] double invalid_radius(View q) override { return own_->invalid_radius(q); }
  [[nodiscard]] std::optional<double> excluded(View a, View b) override { return own_->excluded(a, b); }
  void expect_guided(bool guided) override { guided_ = guided; }
  [[nodiscard]] std::shared_ptr<Validity> for_thread() const override { return guided_ ? nullptr : own_->for_thread(); }

  /// Whether this motion was found valid in C.
  [[nodiscard]] bool valid_in_c(View a, View b);

 private:
  std::shared_ptr<Validity> own_;
  std::shared_ptr<Validity> c_;
  std::uint64_t c_epoch_;                     ///< epoch of C at the last check
  std::unordered_set<std::uint64_t> valid_;   ///< digests of motions found valid in C
  std::unordered_set<std::uint64_t> states_;  ///< digests of configurations found valid in C
  bool guided_ = false;
  double success_ = 1.0;  ///< share of the last motions that were valid in C
  int passed_over_ = 0;   ///< motions since the last check in C
};

}  // namespace trellis
