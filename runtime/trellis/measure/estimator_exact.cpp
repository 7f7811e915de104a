// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <trellis/base/polling.hpp>
#include <trellis/measure/evaluation.hpp>

namespace trellis::measure {

namespace {

struct ExactSettings {};

const Settings<ExactSettings>& exact_settings() {
  static const Settings<ExactSettings> settings(Component::Kind::estimator, "exact",
                                                "no estimation: the recorded densities of the proposals, integrated "
                                                "over the target; for expansion where every h has a density",
                                                "Attali et al. 2022");
  return settings;
}

Estimate estimate(const Options&, const Evaluation& evaluation) {
  // Uses more points than other estimators: recorded densities are narrow and cost no checks, and the pool is the only
  // source of error.
  const Configurations& pool = evaluation.target.pool();
  std::vector<double> log_density(evaluation.pool);
  double mass = 0.0;
  for (std::size_t i = 0; i < evaluation.pool; ++i) {
    poll(i);
    log_density[i] = std::log(evaluation.known_density(pool[i]));
    mass += std::exp(log_density[i] - evaluation.target.log_density(i));
  }
  mass /= static_cast<double>(evaluation.pool);
  Estimate result = estimate_from(evaluation, log_density);
  // The mass of the density itself, without counting.
  result.unregularised_parts.mass = -std::log(std::min(mass, 1.0));
  return result;
}

std::string unfit(const Options&, const Evaluation& evaluation) {
  return evaluation.known_density ? "" : "the density of these samples is not known";
}

}  // namespace

EstimatorKind exact_kind() { return {&exact_settings().component(), unfit, estimate}; }

}  // namespace trellis::measure
