// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <unordered_set>

#include <trellis/instance/forwarding_validity.hpp>

namespace trellis {

/// Validity in a space S that relaxes C and has its coordinates: a motion that is valid in C is valid in S.
///
/// A motion towards a guided proposal is likely to become part of the path. Its validity is checked in C first: if
/// valid there, one check serves both spaces, and C need not check the path again. If too many of the last motions were
/// invalid in C, only some are checked in C first.
class RelaxedValidity final : public ForwardingValidity<> {
 public:
  /// \param own  validity in S
  /// \param c  validity in C, by collision checks
  RelaxedValidity(std::shared_ptr<Validity> own, std::shared_ptr<Validity> c)
      : ForwardingValidity(std::move(own)), c_(std::move(c)), c_epoch_(c_->epoch()) {}

  [[nodiscard]] bool state(View q) override { return inner_->state(q); }
  [[nodiscard]] bool needed(View q) override { return c_->needed(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override;
  /// Other threads check motions in S alone.
  void announce(View a, View b, const MotionReport& report) override { inner_->announce(a, b, report); }
  /// The report counts the checks in both spaces.
  [[nodiscard]] MotionReport motion_still_valid(View a, View b, std::uint64_t since) override {
    return valid_in_c(a, b) ? MotionReport{true, 0, std::numeric_limits<double>::quiet_NaN()}
                            : inner_->motion_still_valid(a, b, since);
  }
  void expect_guided(bool guided) override { guided_ = guided; }
  [[nodiscard]] std::shared_ptr<Validity> for_thread() const override {
    return guided_ ? nullptr : inner_->for_thread();
  }

  /// Whether this motion was found valid in C.
  [[nodiscard]] bool valid_in_c(View a, View b);

 private:
  std::shared_ptr<Validity> c_;
  std::uint64_t c_epoch_;                     ///< epoch of C at the last check
  std::unordered_set<std::uint64_t> valid_;   ///< digests of motions found valid in C
  std::unordered_set<std::uint64_t> states_;  ///< digests of configurations found valid in C
  bool guided_ = false;
  double success_ = 1.0;  ///< share of the last motions that were valid in C
  int passed_over_ = 0;   ///< motions since the last check in C
};

}  // namespace trellis
