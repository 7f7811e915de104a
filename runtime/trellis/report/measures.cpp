// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/measures.hpp>

#include <array>

namespace trellis {

namespace {

/// \param of  returns the field of an efficiency, which may be constant
template <class Of>
constexpr MeasureQuantity stored(const char* group, const char* name, Of /*of*/, Interval Figure::*over_runs,
                                 bool infinite) {
  return {group,
          name,
          [](const Efficiency& e) -> double { return Of{}(e); },
          [](Efficiency& e) -> double& { return Of{}(e); },
          over_runs,
          infinite};
}

// Of two that have the same interval in summaries (mass), the later one's values are averaged.
constexpr auto quantities = std::to_array<MeasureQuantity>({
    stored(
        nullptr, "D", [](auto& e) -> auto& { return e.unregularised; }, &Figure::unregularised, true),
    stored(
        "D_parts", "mass", [](auto& e) -> auto& { return e.unregularised_parts.mass; }, &Figure::mass, true),
    stored(
        "D_parts", "spread", [](auto& e) -> auto& { return e.unregularised_parts.spread; }, &Figure::spread, true),
    stored(
        "D_parts", "along", [](auto& e) -> auto& { return e.unregularised_parts.along; }, nullptr, false),
    stored(
        "D_parts", "across", [](auto& e) -> auto& { return e.unregularised_parts.across; }, nullptr, true),
    stored(
        nullptr, "D_eps", [](auto& e) -> auto& { return e.value; }, &Figure::value, false),
    stored(
        "D_eps_parts", "mass", [](auto& e) -> auto& { return e.parts.mass; }, &Figure::mass_part, true),
    stored(
        "D_eps_parts", "spread", [](auto& e) -> auto& { return e.parts.spread; }, &Figure::spread_part, true),
    stored(
        "D_eps_parts", "along", [](auto& e) -> auto& { return e.parts.along; }, &Figure::along_part, false),
    stored(
        "D_eps_parts", "across", [](auto& e) -> auto& { return e.parts.across; }, &Figure::across_part, true),
    stored(
        nullptr, "D_eps_lo", [](auto& e) -> auto& { return e.value_lo; }, &Figure::value_lo, false),
    stored(
        nullptr, "D_eps_hi", [](auto& e) -> auto& { return e.value_hi; }, &Figure::value_hi, false),
    {nullptr, "scale", [](const Efficiency& e) { return on_scale(e.value, e.perfect, e.uniform); }, nullptr, nullptr,
     false},
    {nullptr, "scale_lo", [](const Efficiency& e) { return on_scale(e.value_lo, e.perfect, e.uniform); }, nullptr,
     nullptr, false},
    {nullptr, "scale_hi", [](const Efficiency& e) { return on_scale(e.value_hi, e.perfect, e.uniform); }, nullptr,
     nullptr, false},
    stored(
        nullptr, "D_eps0.01", [](auto& e) -> auto& { return e.light_value; }, &Figure::light_value, false),
    stored(
        nullptr, "D_perfect", [](auto& e) -> auto& { return e.perfect; }, &Figure::perfect, false),
    stored(
        nullptr, "D_uniform", [](auto& e) -> auto& { return e.uniform; }, &Figure::uniform, false),
    stored(
        nullptr, "gain", [](auto& e) -> auto& { return e.gain; }, &Figure::gain, false),
    stored(
        nullptr, "D_mass", [](auto& e) -> auto& { return e.mass; }, &Figure::mass, true),
    stored(
        nullptr, "D_mass_lower95", [](auto& e) -> auto& { return e.mass_lower95; }, &Figure::mass_lower95, false),
    stored(
        nullptr, "D_mass_lo", [](auto& e) -> auto& { return e.mass_lo; }, nullptr, false),
    stored(
        nullptr, "D_mass_hi", [](auto& e) -> auto& { return e.mass_hi; }, nullptr, true),
    stored(
        nullptr, "JS", [](auto& e) -> auto& { return e.js; }, &Figure::js, false),
    stored(
        nullptr, "coverage", [](auto& e) -> auto& { return e.coverage; }, &Figure::coverage, false),
    stored(
        nullptr, "coverage_half", [](auto& e) -> auto& { return e.coverage_half; }, &Figure::coverage_half, false),
    stored(
        nullptr, "uniform_coverage", [](auto& e) -> auto& { return e.uniform_coverage; }, &Figure::uniform_coverage,
        false),
    stored(
        nullptr, "uniform_coverage_half", [](auto& e) -> auto& { return e.uniform_coverage_half; }, nullptr, false),
    stored(
        nullptr, "free_share", [](auto& e) -> auto& { return e.free_share; }, &Figure::free_share, false),
    stored(
        "along", "D", [](auto& e) -> auto& { return e.along.divergence; }, &Figure::along, true),
    stored(
        "along", "empty_share", [](auto& e) -> auto& { return e.along.empty_share; }, &Figure::empty_share, false),
});

}  // namespace

std::span<const MeasureQuantity> measure_quantities() { return quantities; }

}  // namespace trellis
