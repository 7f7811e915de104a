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
#include <trellis/measure/hitting.hpp>
#include <trellis/measure/target.hpp>

namespace trellis {

class PreparedSamples;

/// The sampling efficiency of one set of samples relative to one target, SE_T(Q) = D_KL(T || Q), in nats, lower is
/// better: the headline values of one estimator, and the values that do not depend on the estimator. A missing value is
/// NaN.
struct Efficiency : Estimate {
  /// log|C| - log|A|, the divergence of uniform sampling of C.
  double uniform = std::numeric_limits<double>::quiet_NaN();
  /// The `value` of perfect guidance, samples of T itself; positive because of the 5 % uniform samples in the mixture.
  /// NaN where T is not uniform.
  double perfect = std::numeric_limits<double>::quiet_NaN();
  /// The 95 % interval of `value` that the samples support: counting certifies the lower end, and the upper end allows
  /// for what so many samples cannot show. Equal to `value` for `exact`. NaN where T is not uniform or not scored.
  double value_lo = std::numeric_limits<double>::quiet_NaN();
  double value_hi = std::numeric_limits<double>::quiet_NaN();
  /// -log Q(A), at most D; and its lower bound with 95 % confidence (Clopper and Pearson, one-sided).
  double mass = std::numeric_limits<double>::quiet_NaN();
  double mass_lower95 = std::numeric_limits<double>::quiet_NaN();
  /// The two-sided 95 % interval of `mass` by Clopper and Pearson; infinite above where no sample lies in A. Repeated
  /// samples count with their multiplicity; `spread` contains the loss due to their missing density.
  double mass_lo = std::numeric_limits<double>::quiet_NaN();
  double mass_hi = std::numeric_limits<double>::quiet_NaN();
  /// The share of A within delta of a sample (full metric).
  double coverage = std::numeric_limits<double>::quiet_NaN();
  /// The share of the tube that is free.
  double free_share = std::numeric_limits<double>::quiet_NaN();
  Along along;
  /// Of the samples in balls along a path, which need not be the target's. Set by those who score several paths.
  Hitting hitting;
  std::size_t samples = 0;    ///< N
  std::size_t in_target = 0;  ///< n, samples in A, copies counted
  std::size_t repeated = 0;   ///< samples that occur more than once: atoms, mass without density
  /// The other requested estimators that have a value.
  std::vector<Estimate> others;
  /// "underpowered" (as many uniform samples would put fewer than 10 into A), "censored" (no sample in A), "partial"
  /// (coverage clearly below that of as many uniform samples), "below mass bound" (D is below the bound from the mass
  /// in A, hence wrong), "too few samples" (fewer than k samples that are not atoms), "lower bound" (`arc`), "empty
  /// target", "cannot reach" (part of T is invalid, where the samples never are). From five degrees of freedom on
  /// "indicative" (`knn`) and "few in target" (1 to 299 samples in A), and neither "underpowered" nor "partial".
  std::vector<std::string> flags;
  /// Why there is no value; "" where there is one.
  std::string reason;
};

/// The possible support of Q: a tree has no density on invalid configurations, so its divergence is infinite for a
/// target with the support "all".
enum class SampleSupport : std::uint8_t { anything, valid_only };

/// How to score samples.
struct Scoring {
  SampleSupport support = SampleSupport::anything;
  /// The first estimator that has a value gives the headline; `others` stores the rest.
  std::vector<EstimatorSpec> estimators = default_estimators();
  /// Whether to compute, of the other estimators, `knn` only.
  bool brief = false;
  /// Whether to compute the headline's estimator only.
  bool headline_only = false;
  /// Whether to compute the interval of the headline.
  bool interval = true;
  /// Whether to compute it from fewer samples and points of the target: it is wider, and takes a fifth of the time.
  bool rough_interval = false;
  /// The density of the samples where the sampler records it (without atoms, per volume in metric coordinates), for
  /// `exact`.
  std::function<double(View)> density = {};
  std::size_t points = 0;  ///< evaluation points, at most the target's; 0: the target's
  std::size_t pool = 0;    ///< points for `exact`, at most the target's pool; 0: the pool
};

/// Scores samples.
/// \param samples  N configurations of the target's space; not sorted, may contain duplicates. Those outside of C count
///     in N but cover no point of A.
/// \throws Error for samples of another dimension or with coordinates that are not finite.
Efficiency efficiency(const Target& target, const Configurations& samples, const Scoring& scoring = {});

/// The same for prepared samples, which saves most of the work where several targets score the same samples.
/// \throws Error for samples of another space than the target's.
Efficiency efficiency(const Target& target, const PreparedSamples& samples, const Scoring& scoring = {});

/// Returns the lower bound of SE, in nats, that follows from the bound of the mass; NaN where T is not uniform.
double least_value(const Efficiency& efficiency);

/// Returns the values as reports show them: where an estimate lies below its certain bound, the bound replaces it. D is
/// at least `mass_lower95`, SE at least its consequence, no part is negative, and the parts sum to the whole. Means
/// over runs must use the estimates themselves; otherwise they are biased.
Efficiency shown(Efficiency efficiency);

/// Returns the values as results store them: with seven significant digits, far finer than any interval, and shares
/// along the path in ten thousandths. Documents have a fifth of the size, and their reports equal those of the run.
Efficiency rounded(Efficiency efficiency);

/// Returns why an interval of SE shows too little to be printed; "" where it shows on which side of uniform sampling
/// the samples are, or is at most `most_width` wide.
/// \param lo, hi  ends of the interval of SE, nats
/// \param uniform  SE of uniform sampling, nats
std::string blank_reason(double lo, double hi, double uniform);
inline constexpr double most_width = 1.0;  ///< nats

/// Whether a target leaves nothing to show: uniform sampling is within `least_scale` of perfect guidance, because the
/// target covers nearly the whole space.
bool covers_space(double uniform);
inline constexpr double least_scale = 0.25;  ///< nats

/// Averages the results for several targets, `along` too (over the least number of bins). Infinite values give
/// infinity; a value that some targets lack is the mean over the others. Keeps the flags that at least half of the
/// targets raise.
/// \param figures  at least one
Efficiency mean(std::span<const Efficiency> figures);

}  // namespace trellis
