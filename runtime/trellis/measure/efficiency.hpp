// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <trellis/measure/target.hpp>

namespace trellis {

/// The sampling efficiency of one set of samples against one target, SE_T(Q) = D_KL(T || Q), in nats, lower is better.
/// A figure that does not exist is NaN.
struct Efficiency {
  /// The headline: D(T || (1-eps) Q + eps Uniform(C)), finite for every Q that has samples.
  double value = std::numeric_limits<double>::quiet_NaN();
  /// D(T || Q) undefended; +inf where no sample lies in A.
  double undefended = std::numeric_limits<double>::quiet_NaN();
  /// log|C| - log|A|, the divergence of uniform sampling of C.
  double uniform = std::numeric_limits<double>::quiet_NaN();
  /// uniform - value: nats won over blind sampling.
  double gain = std::numeric_limits<double>::quiet_NaN();
  /// Share of A within delta of a sample (full metric), and what as many uniform samples would reach (expected).
  double coverage = std::numeric_limits<double>::quiet_NaN();
  double uniform_coverage = std::numeric_limits<double>::quiet_NaN();
  std::size_t samples = 0;    ///< N
  std::size_t in_target = 0;  ///< n, samples in A
  std::string estimator = "knn";
  /// "underpowered" (as many uniform samples would put fewer than 10 into A), "censored" (no sample in A), "partial"
  /// (coverage below uniform's), "too few samples" (fewer than k that are no atoms), "empty target", "cannot reach"
  /// (part of T is invalid, and the samples can never be).
  std::vector<std::string> flags;
};

/// Scores samples with the default estimator, blended k nearest neighbours (k = 3) with boundary correction,
/// wrap-around and atoms (exact duplicates carry mass but no density).
/// \param samples  N configurations of the target's space; not sorted, may hold duplicates; those outside of C count in
///                 N but can reach no point of A
/// \param held     what Q can hold at all: a tree has no density on invalid configurations, so that with the support
///                 "all" its divergence is infinite
/// Throws Error for samples of another dimension or with coordinates that are not finite.
enum class Held : std::uint8_t { anything, valid_only };
Efficiency efficiency(const Target& target, const Configurations& samples, Held held = Held::anything);

}  // namespace trellis
