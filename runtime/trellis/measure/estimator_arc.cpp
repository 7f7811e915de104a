// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <span>

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
          .integer("dimension", &ArcSettings::dimension, "degrees of freedom", {.lo = 1, .hi = 1000},
                   "spaces of fewer have no such figure");
  return settings;
}

Estimate estimate(const Options&, const Evaluation& evaluation) {
  const Target& target = evaluation.target;
  const auto total = static_cast<double>(evaluation.samples.total());
  // Repeated samples have no density, so they lower no divergence: count only the others, whose arcs come first.
  const std::size_t once = evaluation.in_target.inside.size() / evaluation.frame().dimension();
  const double share = static_cast<double>(once) / total;
  const double mass = once > 0 ? -std::log(share) : mass_without_hit(evaluation.samples.total());
  const Along along = along_path(target, std::span(evaluation.in_target.arcs).first(once), evaluation.points, share);
  // Too few samples in the target give no evidence about their distribution along it.
  const auto or_nothing = [](double divergence) { return std::isnan(divergence) ? 0.0 : divergence; };
  Estimate result;
  result.unregularised = mass + or_nothing(along.corrected);
  result.value = regularised_mass(mass, target.uniform()) + or_nothing(along.regularised);
  result.above_uniform = target.uniform() - result.value;
  return result;
}

std::string unfit(const Options& options, const Evaluation& evaluation) {
  const auto least = static_cast<std::size_t>(arc_settings().read(options).dimension);
  const std::size_t d = evaluation.frame().degrees();
  if (!evaluation.target.has_path()) return "the target has no path";
  if (d < least) return fmt::format("the space has {} dimensions, fewer than {}", d, least);
  if (!evaluation.unreachable.empty()) return "part of the target cannot be reached";
  return "";
}

}  // namespace

EstimatorKind arc_kind() { return {&arc_settings().component(), unfit, estimate}; }

}  // namespace trellis::measure
