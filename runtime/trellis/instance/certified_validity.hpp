// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <utility>

#include <trellis/instance/forwarding_validity.hpp>

namespace trellis {

/// A validity whose motions are certified one by one (Certificate), for worlds in which the resolution is too coarse:
/// no obstacle is thin enough to pass between two configurations.
class CertifiedValidity final : public ForwardingValidity<> {
 public:
  /// \param tolerance  metres, see Certificate::tolerance
  CertifiedValidity(std::shared_ptr<Validity> inner, double tolerance)
      : ForwardingValidity(std::move(inner)), tolerance_(tolerance) {}

  [[nodiscard]] bool state(View q) override { return inner_->state(q); }
  /// The configurations that the certificate needs count as checks.
  [[nodiscard]] MotionReport motion(View a, View b) override {
    MotionReport report = inner_->motion(a, b);
    if (!report.valid) return report;
    // Only whether it is free of contact is asked: no distance above the tolerance is needed.
    Certificate certificate{.tolerance = tolerance_, .nearest = tolerance_};
    inner_->certify(a, b, certificate);
    report.checks += static_cast<std::uint32_t>(certificate.checks);
    if (certificate.valid()) return report;
    return {false, report.checks, *certificate.refuted_at};
  }
  void certify(View a, View b, Certificate& certificate) override { inner_->certify(a, b, certificate); }

 private:
  double tolerance_;
};

}  // namespace trellis
