// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/estimator.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <trellis/measure/evaluation.hpp>

namespace trellis {

namespace measure {

const std::vector<EstimatorKind>& estimator_kinds() {
  static const std::vector<EstimatorKind> kinds = {knn_kind(), exact_kind(),     arc_kind(),
                                                   kde_kind(), histogram_kind(), legacy_kind()};
  return kinds;
}

const EstimatorKind* find_estimator(std::string_view name) {
  const auto& kinds = estimator_kinds();
  const auto it =
      std::find_if(kinds.begin(), kinds.end(), [&](const EstimatorKind& kind) { return kind.component->name == name; });
  return it != kinds.end() ? &*it : nullptr;
}

namespace {

/// log(exp(a) + exp(b)).
double log_sum(double a, double b) {
  const double larger = std::max(a, b);
  if (!std::isfinite(larger)) return larger;
  return larger + std::log1p(std::exp(std::min(a, b) - larger));
}

}  // namespace

double mass_without_hit(std::size_t samples) { return -std::log(0.5 / (static_cast<double>(samples) + 1.0)); }

Estimate estimate_from(const Evaluation& evaluation, std::span<const double> log_density, double mass) {
  const Target& target = evaluation.target;
  const double log_uniform = -target.space().log_volume();
  const auto count = static_cast<double>(log_density.size());
  double plain = 0.0;
  double regularised = 0.0;
  double light = 0.0;
  double own = 0.0;    // log T
  double total = 0.0;  // the mass of q in A, by the evaluation points
  double target_js = 0.0;
  double sample_js = 0.0;
  for (std::size_t i = 0; i < log_density.size(); ++i) {
    const double log_t = target.log_density(i);
    const bool reachable = evaluation.unreachable.empty() || evaluation.unreachable[i] == 0;
    const double log_q = reachable ? log_density[i] : -std::numeric_limits<double>::infinity();
    own += log_t;
    plain += log_q;
    regularised += log_sum(std::log1p(-uniform_mix) + log_q, std::log(uniform_mix) + log_uniform);
    light += log_sum(std::log1p(-light_uniform_mix) + log_q, std::log(light_uniform_mix) + log_uniform);
    const double ratio = std::exp(log_q - log_t);
    total += ratio;
    target_js += std::numbers::ln2 - std::log1p(ratio);
    if (ratio > 0.0) sample_js += ratio * (std::numbers::ln2 - std::log1p(1.0 / ratio));
  }
  Estimate result;
  result.unregularised = (own - plain) / count;
  result.value = (own - regularised) / count;
  result.light_value = (own - light) / count;
  result.gain = target.uniform() - result.value;
  // The part of Q outside of A, and its atoms, share no point with T: log 2 each. The rest of Q is an integral over A,
  // normalised to the counted mass.
  if (total > 0.0) sample_js *= mass / (total / count) / count;
  result.js =
      std::clamp(0.5 * (target_js / count + sample_js + (1.0 - mass) * std::numbers::ln2), 0.0, std::numbers::ln2);
  return result;
}

}  // namespace measure

EstimatorSpec EstimatorSpec::make(const std::string& name, const std::vector<Options::Entry>& given) {
  const auto* kind = measure::find_estimator(name);
  if (kind == nullptr) {
    std::vector<std::string> known;
    for (const auto& k : measure::estimator_kinds()) known.push_back(k.component->name);
    throw Error(
        fmt::format("no estimator '{}'{}; estimators are {}", name, did_you_mean(name, known), fmt::join(known, ", ")));
  }
  EstimatorSpec spec;
  spec.name_ = name;
  spec.options_ = Options::validate(*kind->component, given);
  return spec;
}

std::string EstimatorSpec::text() const {
  const Component& component = *measure::find_estimator(name_)->component;
  std::string text;
  for (std::size_t i = 0; i < component.options.size(); ++i) {
    const auto& [option, value] = options_.entries()[i];
    if (value == component.options[i].default_value) continue;
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", option, to_string(value));
  }
  return text.empty() ? name_ : fmt::format("{} {{ {} }}", name_, text);
}

std::string unfit_in(const Space& space, const EstimatorSpec& estimator) {
  const std::string& name = estimator.name();
  if (space.flat() || name == "exact" || name == "arc" || name == "knn") return "";
  return fmt::format("{} needs a space of independent axes, and {} has rotations: use exact, arc or knn", name,
                     space.name());
}

double regularised_mass(double mass, double uniform) {
  return -std::log((1.0 - uniform_mix) * std::exp(-mass) + uniform_mix * std::exp(-uniform));
}

const std::vector<EstimatorSpec>& default_estimators() {
  static const std::vector<EstimatorSpec> estimators = {EstimatorSpec::make("exact"), EstimatorSpec::make("arc"),
                                                        EstimatorSpec::make("knn")};
  return estimators;
}

}  // namespace trellis
