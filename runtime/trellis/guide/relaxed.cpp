// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/relaxed.hpp>

namespace trellis {

MotionReport RelaxedValidity::motion(View a, View b) {
  // A lower share indicates that the guide of the search leads to invalid parts of C.
  constexpr double least_success = 0.6;
  constexpr double memory = 0.5;
  constexpr int every = 8;
  if (!guided_) return inner_->motion(a, b);
  if (valid_in_c(a, b)) return {true, 0, std::numeric_limits<double>::quiet_NaN()};
  if (success_ < least_success && ++passed_over_ < every) return inner_->motion(a, b);
  passed_over_ = 0;
  // A motion check presumes a valid first configuration, which is known for S only.
  MotionReport in_c;
  const bool known = states_.contains(configuration_digest(a));
  if (!known) in_c.checks = 1;
  if (known || c_->state(a)) {
    if (!known) states_.insert(configuration_digest(a));
    const std::uint32_t before = in_c.checks;
    in_c = c_->motion(a, b);
    in_c.checks += before;
  }
  success_ = memory * success_ + (in_c.valid ? 1.0 - memory : 0.0);
  if (in_c.valid) {
    states_.insert(configuration_digest(b));
    valid_.insert(motion_digest(a, b));
    return in_c;
  }
  MotionReport report = inner_->motion(a, b);
  report.checks += in_c.checks;
  return report;
}

bool RelaxedValidity::valid_in_c(View a, View b) {
  if (c_epoch_ != c_->epoch()) {
    c_epoch_ = c_->epoch();
    valid_.clear();
    states_.clear();
  }
  return valid_.contains(motion_digest(a, b)) && !c_->enters_excluded(a, b);
}

}  // namespace trellis
