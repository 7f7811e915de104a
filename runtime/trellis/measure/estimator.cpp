// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/estimator.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <trellis/measure/evaluation.hpp>

namespace trellis {

namespace measure {

const std::vector<EstimatorKind>& estimator_kinds() {
  static const std::vector<EstimatorKind> kinds = {knn_kind(), exact_kind(), arc_kind()};
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

Estimate estimate_from(const Evaluation& evaluation, std::span<const double> log_density) {
  const Target& target = evaluation.target;
  const double log_uniform = -target.space().log_volume();
  const auto count = static_cast<double>(log_density.size());
  double plain = 0.0;
  double regularised = 0.0;
  double own = 0.0;  // log T
  for (std::size_t i = 0; i < log_density.size(); ++i) {
    const bool reachable = evaluation.unreachable.empty() || evaluation.unreachable[i] == 0;
    const double log_q = reachable ? log_density[i] : -std::numeric_limits<double>::infinity();
    own += target.log_density(i);
    plain += log_q;
    regularised += log_sum(std::log1p(-uniform_mix) + log_q, std::log(uniform_mix) + log_uniform);
  }
  Estimate result;
  result.unregularised = (own - plain) / count;
  result.value = (own - regularised) / count;
  result.above_uniform = target.uniform() - result.value;
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

double regularised_mass(double mass, double uniform) {
  return -std::log((1.0 - uniform_mix) * std::exp(-mass) + uniform_mix * std::exp(-uniform));
}

const std::vector<EstimatorSpec>& default_estimators() {
  static const std::vector<EstimatorSpec> estimators = {EstimatorSpec::make("exact"), EstimatorSpec::make("arc"),
                                                        EstimatorSpec::make("knn")};
  return estimators;
}

}  // namespace trellis
