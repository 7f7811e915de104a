// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/measure/target.hpp>

namespace trellis {

/// The share of uniform samples mixed into Q for the regularised divergence.
inline constexpr double uniform_mix = 0.05;

/// A divergence by the chain rule, with A the support of T: D(T || Q) = -log Q(A) + D(T || Q given A). The parts of a
/// finite divergence sum to it.
struct ChainRule {
  /// -log Q(A): the smaller the share of samples in the target, the larger.
  double mass = std::numeric_limits<double>::quiet_NaN();
  /// D(T || Q given A): how unevenly the samples in A cover it. NaN without a sample in A.
  double spread = std::numeric_limits<double>::quiet_NaN();
  /// The parts of the spread: the divergence of arc length along the path, and the rest across it. NaN without a path;
  /// the part across is also NaN from `most_across` degrees of freedom on, where samples do not show it.
  double along = std::numeric_limits<double>::quiet_NaN();
  double across = std::numeric_limits<double>::quiet_NaN();
};
inline constexpr std::size_t most_across = 5;

/// Returns -log of the mass in A of Q mixed with 5 % uniform samples.
/// \param mass     -log Q(A)
/// \param uniform  -log of the mass in A of uniform sampling
double regularised_mass(double mass, double uniform);

/// The result of one estimator for a set of samples, in nats. A missing value is NaN.
struct Estimate {
  std::string estimator = "knn";
  /// SE, the headline: D(T || (1-eps) Q + eps Uniform(C)), eps = 0.05; finite for every Q with samples, at most
  /// log(1/eps) + uniform.
  double value = std::numeric_limits<double>::quiet_NaN();
  /// D(T || Q) of the samples as they are, with nothing mixed in; +inf where Q has no density on a part of T, and where
  /// no sample lies in A.
  double unregularised = std::numeric_limits<double>::quiet_NaN();
  /// Nats above uniform, uniform - value, as reports print it. More is better; 0 is uniform sampling.
  double above_uniform = std::numeric_limits<double>::quiet_NaN();
  /// The parts of `value`; NaN where T is not uniform.
  ChainRule parts = {};
  /// The parts of `unregularised`.
  ChainRule unregularised_parts = {};
};

/// An estimator with its validated options.
class EstimatorSpec {
 public:
  /// \throws Error for an unknown estimator (with the nearest name) or a wrong option.
  static EstimatorSpec make(const std::string& name, const std::vector<Options::Entry>& given = {});
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Options& options() const { return options_; }
  /// Returns the name and the options that differ from their defaults: "knn { k = 5 }".
  [[nodiscard]] std::string text() const;
  friend bool operator==(const EstimatorSpec&, const EstimatorSpec&) = default;

 private:
  std::string name_;
  Options options_;
};

/// Returns the default order: recorded densities, else the bound by arc length from five degrees of freedom on, else
/// nearest neighbours: { exact, arc, knn }.
const std::vector<EstimatorSpec>& default_estimators();

namespace measure {

struct Evaluation;

/// One kind of estimator.
struct EstimatorKind {
  const Component* component = nullptr;
  /// Returns why it has no value for these samples; "" where it has one.
  std::string (*unfit)(const Options&, const Evaluation&) = nullptr;
  Estimate (*estimate)(const Options&, const Evaluation&) = nullptr;
};

/// Returns all estimators, in the order of the reference.
const std::vector<EstimatorKind>& estimator_kinds();
const EstimatorKind* find_estimator(std::string_view name);

EstimatorKind knn_kind();
EstimatorKind exact_kind();
EstimatorKind arc_kind();

}  // namespace measure

}  // namespace trellis
