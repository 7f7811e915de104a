// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <trellis/measure/along.hpp>
#include <trellis/measure/estimator.hpp>
#include <trellis/measure/target.hpp>

namespace trellis {

class PreparedSamples;

/// The sampling efficiency of one set of samples against one target, SE_T(Q) = D_KL(T || Q), in nats, lower is better:
/// the headline figures of one estimator, and what holds whichever estimator is asked. A figure that does not exist is
/// NaN.
struct Efficiency : Estimate {
  /// log|C| - log|A|, the divergence of uniform sampling of C.
  double uniform = std::numeric_limits<double>::quiet_NaN();
  /// What `value` is of perfect guidance, samples of T itself: the price of the 5 % uniform ones that are mixed in.
  /// `perfect` and `uniform` frame the scale. NaN where T is not uniform.
  double perfect = std::numeric_limits<double>::quiet_NaN();
  /// -log Q(A), at most D; and its lower end with 95 % confidence (Clopper and Pearson, one-sided).
  double mass = std::numeric_limits<double>::quiet_NaN();
  double mass_lower95 = std::numeric_limits<double>::quiet_NaN();
  /// The two-sided 95 % interval of `mass`, Clopper and Pearson's; infinite above where no sample lies in A. Samples
  /// that occur more than once count, each time that they do; what is lost by their having no density is spread.
  double mass_lo = std::numeric_limits<double>::quiet_NaN();
  double mass_hi = std::numeric_limits<double>::quiet_NaN();
  /// Share of A within delta of a sample (full metric), and what as many uniform samples would reach (expected); the
  /// same within delta / 2.
  double coverage = std::numeric_limits<double>::quiet_NaN();
  double uniform_coverage = std::numeric_limits<double>::quiet_NaN();
  double coverage_half = std::numeric_limits<double>::quiet_NaN();
  double uniform_coverage_half = std::numeric_limits<double>::quiet_NaN();
  /// The free share of the tube.
  double free_share = std::numeric_limits<double>::quiet_NaN();
  Along along;
  std::size_t samples = 0;    ///< N
  std::size_t in_target = 0;  ///< n, samples in A, copies counted
  std::size_t repeated = 0;   ///< samples that occur more than once: atoms, mass without density
  /// The further estimators that were asked for and have a figure.
  std::vector<Estimate> others;
  /// "underpowered" (as many uniform samples would put fewer than 10 into A), "censored" (no sample in A), "partial"
  /// (coverage clearly below uniform's), "below mass bound" (D is below the bound that the mass in A sets: wrong), "too
  /// few samples" (fewer than k that are no atoms), "lower bound" (`arc`), "indicative" (`knn` from five dimensions
  /// on), "empty target", "cannot reach" (part of T is invalid, and the samples can never be).
  std::vector<std::string> flags;
  /// Why there is no figure; "" where there is one.
  std::string reason;
};

/// What Q can hold at all: a tree has no density on invalid configurations, so that with the support "all" its
/// divergence is infinite.
enum class Held : std::uint8_t { anything, valid_only };

/// How samples are scored.
struct Scoring {
  Held held = Held::anything;
  /// The first that has a figure gives the headline, the others stand beside it.
  std::vector<EstimatorSpec> estimators = default_estimators();
  /// Whether, of those that stand beside the headline, `knn` alone is asked.
  bool brief = false;
  /// Whether the headline's estimator alone is asked.
  bool headline_only = false;
  /// The density of the samples where it is known (without atoms, per volume in metric coordinates), for `exact`.
  std::function<double(View)> density = {};
  std::size_t points = 0;         ///< evaluation points, at most the target's; 0: the target's
  std::size_t kernel_points = 0;  ///< the first of them, which `kde` is averaged over; 0: all
};

/// Scores samples.
/// \param samples  N configurations of the target's space; not sorted, may hold duplicates; those outside of C count in
///                 N but can reach no point of A
/// Throws Error for samples of another dimension or with coordinates that are not finite.
Efficiency efficiency(const Target& target, const Configurations& samples, const Scoring& scoring = {});

/// The same of samples that were made ready before, which spares most of that work where they are scored on several
/// targets. Throws Error where they are of another space than the target.
Efficiency efficiency(const Target& target, const PreparedSamples& samples, const Scoring& scoring = {});

/// What D_eps is at least, by the certain bound of the mass; NaN where T is not uniform.
double least_value(const Efficiency& efficiency);

/// The same figures as they are shown: an estimate cannot be below what is certain, so one that is stands as its bound.
/// D is at least `mass_lower95`, D_eps at least what follows from it, no part is negative, and the parts sum to the
/// whole. Means over runs are taken of the estimates as they are, else they would be biased.
Efficiency shown(Efficiency efficiency);

/// One figure for several targets: means over them, of `along` too (over the least number of bins that one has);
/// infinite values give infinity, and figures that some targets lack are means over those that have them. Flags are
/// those raised by half of them at least.
Efficiency mean(std::span<const Efficiency> figures);

}  // namespace trellis
