// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/certificate.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/base/thread_scratch.hpp>

namespace trellis {

namespace {

/// The same where distances are inexact.
constexpr double coarse_share = 0.5;
/// So many configurations decide a motion, or it is refuted.
constexpr std::uint64_t most_checks = std::uint64_t{1} << 21U;

/// A part of a motion, by its middle and half its length, as shares of the motion.
struct Interval {
  double middle;
  double half;
};

/// Two generations of intervals, the later ones about half as long.
struct Generations {
  std::vector<Interval> present;
  std::vector<Interval> next;
};

void divide(std::vector<Interval>& intervals, double from, double to, double displacement, double first) {
  const double parts = std::clamp(std::ceil((to - from) * displacement / first), 1.0, 65536.0);
  const double half = 0.5 * (to - from) / parts;
  for (double i = 0.0; i < parts; ++i) intervals.push_back({from + (2.0 * i + 1.0) * half, half});
}

}  // namespace

void add_motion(Certificate& certificate, MotionClearance& motion, double displacement, double first,
                std::span<const double> breaks) {
  ThreadScratch<Generations> scratch;
  auto& [intervals, next] = *scratch;
  intervals.clear();
  double from = 0.0;
  for (const double at : breaks) {
    divide(intervals, from, at, displacement, first);
    from = at;
  }
  divide(intervals, from, 1.0, displacement, first);
  const std::optional<double> measured_from = motion.measured_from();
  const std::uint64_t limit = certificate.checks + most_checks;
  const auto keep = [&] { return certified_share * certificate.nearest; };
  // Whether the distance that came last is inexact.
  bool coarse = false;
  const auto refute = [&](double at) { certificate.refuted_at = at; };
  while (!intervals.empty()) {
    next.clear();
    for (std::size_t begin = 0; begin < intervals.size(); begin += MotionClearance::lanes) {
      const std::span batch(&intervals[begin], std::min<std::size_t>(MotionClearance::lanes, intervals.size() - begin));
      std::array<double, MotionClearance::lanes> middles{};
      double longest = 0.0;
      for (std::size_t i = 0; i < batch.size(); ++i) {
        middles.at(i) = batch[i].middle;
        longest = std::max(longest, batch[i].half);
      }
      announce_motion_checks(static_cast<std::uint32_t>(batch.size()));
      certificate.checks += batch.size();
      const unsigned apart =
          std::isfinite(keep()) ? motion.apart(std::span(middles).first(batch.size()), longest, keep()) : 0U;
      // Contact on a whole batch is found early.
      const std::size_t sure_to_measure = apart == 0 ? batch.size() / 2 : batch.size();
      for (std::size_t i = 0; i < batch.size(); ++i) {
        if (((apart >> i) & 1U) != 0) continue;
        const auto [middle, half] = batch[i];
        // A distance costs as much as many configurations that `apart` decides: it is computed where the interval is so
        // short that it decides.
        const double share = measured_from.value_or(1.0 - (coarse ? coarse_share : certified_share));
        const double decisive = std::max(share * certificate.nearest, certificate.tolerance);
        if (i != sure_to_measure && std::isfinite(decisive) && half * displacement > decisive) {
          next.push_back({middle - 0.5 * half, 0.5 * half});
          next.push_back({middle + 0.5 * half, 0.5 * half});
          continue;
        }
        const auto near = motion.near(middle, half, certificate.nearest);
        if (near.distance <= 0.0 || certificate.checks > limit) return refute(middle);
        certificate.nearest = std::min(certificate.nearest, near.distance);
        coarse = near.inexact;
        // Shorter intervals show at most twice as much about this configuration.
        const bool enough = coarse && near.sure > 0.0 && near.sure >= half * displacement;
        if (near.sure >= keep() || enough) {
          certificate.clearance = std::min(certificate.clearance, near.sure);
          continue;
        }
        if (half * displacement <= certificate.tolerance) {
          // Also certain where the configuration alone shows it.
          if (near.sure > 0.0) {
            certificate.clearance = std::min(certificate.clearance, near.sure);
            continue;
          }
          return refute(middle);
        }
        next.push_back({middle - 0.5 * half, 0.5 * half});
        next.push_back({middle + 0.5 * half, 0.5 * half});
      }
    }
    std::swap(intervals, next);
  }
  certificate.clearance = std::min(certificate.clearance, keep());
}

}  // namespace trellis
