// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/measures.hpp>

#include <array>

namespace trellis {

namespace {

using E = const Efficiency&;

// Of two that have the same interval in summaries (mass), the later one's values are averaged.
constexpr auto quantities = std::to_array<MeasureQuantity>({
    {nullptr, "D", [](E e) { return e.unregularised; }, &Figure::unregularised, true},
    {"D_parts", "mass", [](E e) { return e.unregularised_parts.mass; }, &Figure::mass, true},
    {"D_parts", "spread", [](E e) { return e.unregularised_parts.spread; }, &Figure::spread, true},
    {"D_parts", "along", [](E e) { return e.unregularised_parts.along; }, nullptr, false},
    {"D_parts", "across", [](E e) { return e.unregularised_parts.across; }, nullptr, true},
    {nullptr, "D_eps", [](E e) { return e.value; }, &Figure::value, false},
    {"D_eps_parts", "mass", [](E e) { return e.parts.mass; }, &Figure::mass_part, true},
    {"D_eps_parts", "spread", [](E e) { return e.parts.spread; }, &Figure::spread_part, true},
    {"D_eps_parts", "along", [](E e) { return e.parts.along; }, &Figure::along_part, false},
    {"D_eps_parts", "across", [](E e) { return e.parts.across; }, &Figure::across_part, true},
    {nullptr, "D_eps_lo", [](E e) { return e.value_lo; }, &Figure::value_lo, false},
    {nullptr, "D_eps_hi", [](E e) { return e.value_hi; }, &Figure::value_hi, false},
    {nullptr, "scale", [](E e) { return on_scale(e.value, e.perfect, e.uniform); }, nullptr, false},
    {nullptr, "scale_lo", [](E e) { return on_scale(e.value_lo, e.perfect, e.uniform); }, nullptr, false},
    {nullptr, "scale_hi", [](E e) { return on_scale(e.value_hi, e.perfect, e.uniform); }, nullptr, false},
    {nullptr, "D_eps0.01", [](E e) { return e.light_value; }, &Figure::light_value, false},
    {nullptr, "D_perfect", [](E e) { return e.perfect; }, &Figure::perfect, false},
    {nullptr, "D_uniform", [](E e) { return e.uniform; }, &Figure::uniform, false},
    {nullptr, "gain", [](E e) { return e.gain; }, &Figure::gain, false},
    {nullptr, "D_mass", [](E e) { return e.mass; }, &Figure::mass, true},
    {nullptr, "D_mass_lower95", [](E e) { return e.mass_lower95; }, &Figure::mass_lower95, false},
    {nullptr, "D_mass_lo", [](E e) { return e.mass_lo; }, nullptr, false},
    {nullptr, "D_mass_hi", [](E e) { return e.mass_hi; }, nullptr, true},
    {nullptr, "JS", [](E e) { return e.js; }, &Figure::js, false},
    {nullptr, "coverage", [](E e) { return e.coverage; }, &Figure::coverage, false},
    {nullptr, "coverage_half", [](E e) { return e.coverage_half; }, &Figure::coverage_half, false},
    {nullptr, "uniform_coverage", [](E e) { return e.uniform_coverage; }, &Figure::uniform_coverage, false},
    {nullptr, "uniform_coverage_half", [](E e) { return e.uniform_coverage_half; }, nullptr, false},
    {nullptr, "free_share", [](E e) { return e.free_share; }, &Figure::free_share, false},
    {"along", "D", [](E e) { return e.along.divergence; }, &Figure::along, true},
    {"along", "empty_share", [](E e) { return e.along.empty_share; }, &Figure::empty_share, false},
});

}  // namespace

std::span<const MeasureQuantity> measure_quantities() { return quantities; }

}  // namespace trellis
