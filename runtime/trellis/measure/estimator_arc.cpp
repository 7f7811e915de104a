// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include <trellis/measure/evaluation.hpp>

namespace trellis::measure {

namespace {

struct ArcSettings {
  std::int64_t dimension = static_cast<std::int64_t>(most_across);
};

const Settings<ArcSettings>& arc_settings() {
  static const Settings<ArcSettings> settings =
      Settings<ArcSettings>(
          Component::Kind::estimator, "arc",
          "a lower bound that needs no density: the mass in the target, by counting, and the divergence "
          "of arc length along the path; the headline where nearest neighbours fail",
          "the chain rule")
          .integer("dimension", &ArcSettings::dimension, "axes", {.lo = 1, .hi = 1000},
                   "spaces of fewer dimensions have no such figure");
  return settings;
}

Estimate estimate(const Options&, const Evaluation& evaluation) {
  const Target& target = evaluation.target;
  const auto total = static_cast<double>(evaluation.samples.total());
  const double inside = static_cast<double>(evaluation.in_target.count);
  const double mass = inside > 0.0 ? -std::log(inside / total) : mass_without_hit(evaluation.samples.total());
  // Too few samples in the target say nothing of where along it they lie.
  const auto or_nothing = [](double divergence) { return std::isnan(divergence) ? 0.0 : divergence; };
  const auto defended = [&](double share, double along) {
    const double mixed = share * std::exp(-target.uniform());
    return -std::log((1.0 - share) * std::exp(-mass) + mixed) + along;
  };
  Estimate result;
  result.undefended = mass + or_nothing(evaluation.along.corrected);
  result.value = defended(defence, or_nothing(evaluation.along.defended));
  result.light_value = defended(light_defence, or_nothing(evaluation.along.defended));
  result.gain = target.uniform() - result.value;
  return result;
}

std::string unfit(const Options& options, const Evaluation& evaluation) {
  const auto least = static_cast<std::size_t>(arc_settings().read(options).dimension);
  const std::size_t d = evaluation.frame().dimension();
  if (!evaluation.target.has_path()) return "the target has no path";
  if (d < least) return fmt::format("the space has {} dimensions, fewer than {}", d, least);
  if (!evaluation.unreachable.empty()) return "part of the target cannot be reached";
  return "";
}

}  // namespace

EstimatorKind arc_kind() { return {&arc_settings().component(), unfit, estimate}; }

}  // namespace trellis::measure
