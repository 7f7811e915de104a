// SPDX-License-Identifier: GPL-3.0-or-later
// The quantities that results have. Documents, tables in CSV, `trellis measure`, help and the glossary use these lists.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <trellis/results/facts.hpp>

namespace trellis {

/// Which values of a quantity are better.
enum class Better : std::uint8_t { none, less, more };

/// What a number of a result is called, and what it means.
struct Quantity {
  const char* group;   ///< the object of JSON that has it, "" where it has no object of its own
  const char* key;     ///< in that object
  const char* symbol;  ///< of papers, "" for none
  const char* unit;    ///< "" of a count
  Better better;
  const char* meaning;

  /// The one name of it, in JSON, CSV and help: "SE", "SE_parts.mass".
  [[nodiscard]] std::string name() const { return *group == '\0' ? key : std::string(group) + '.' + key; }
  /// Whether that is its name.
  [[nodiscard]] constexpr bool is(std::string_view name) const {
    const std::string_view before = group;
    if (!before.empty()) {
      if (!name.starts_with(before) || name.substr(before.size(), 1) != ".") return false;
      name.remove_prefix(before.size() + 1);
    }
    return name == key;
  }
};

/// One quantity of the measure, and where a run has it.
struct MeasureQuantity : Quantity {
  double (*of_run)(const Efficiency&);
  double& (*field)(Efficiency&);  ///< where a run stores it; nullptr: computed from others
  bool in_runs;                   ///< whether documents of runs have it, with its interval; else `trellis measure`
  bool of_estimate;               ///< whether each estimator has one
  bool in_table;                  ///< whether tables of runs have a column of it
};

/// One number of a run.
struct RunQuantity : Quantity {
  std::variant<double RunTotals::*, std::uint64_t RunTotals::*> field;
  bool clock = false;  ///< a time that no two runs share
};

namespace quantity_lines {

/// \param of  returns the field of an efficiency, which may be constant
template <class Of>
constexpr MeasureQuantity stored(Quantity quantity, Of /*of*/, bool in_runs = false, bool in_table = false) {
  return {quantity,
          [](const Efficiency& e) -> double { return Of{}(e); },
          [](Efficiency& e) -> double& { return Of{}(e); },
          in_runs,
          false,
          in_table};
}

/// One that each estimator has.
template <class Of>
constexpr MeasureQuantity estimated(Quantity quantity, Of of, bool in_runs = false, bool in_table = false) {
  MeasureQuantity result = stored(quantity, of, in_runs, in_table);
  result.of_estimate = true;
  return result;
}

constexpr MeasureQuantity computed(Quantity quantity, double (*of)(const Efficiency&)) {
  return {quantity, of, nullptr, false, false, false};
}

/// The ends of the 95 % interval of the part `mass` of SE.
inline double mass_lo(const Efficiency& e) { return regularised_mass(e.mass_lo, e.uniform); }
inline double mass_hi(const Efficiency& e) { return regularised_mass(e.mass_hi, e.uniform); }

inline constexpr const char* parts = "SE_parts";
inline constexpr const char* hitting = "hitting";
inline constexpr const char* bottleneck = "bottleneck";

}  // namespace quantity_lines

/// Those of the measure, in the order of reports; those of a group follow one another. A new one is a line here.
inline constexpr auto measure_quantities = std::to_array<MeasureQuantity>({
    quantity_lines::stored(
        {quantity_lines::hitting, "nats", "", "nats", Better::more,
         "how much sooner than uniform samples these hit the balls along a path in turn, by position: the log ratio of "
         "the expected numbers of samples"},
        [](auto& e) -> auto& { return e.hitting.position.hitting; }, true, true),
    quantity_lines::stored(
        {quantity_lines::hitting, "lo", "", "nats", Better::more,
         "the lower end of Student's 95 % interval of hitting.nats over runs"},
        [](auto& e) -> auto& { return e.hitting.position.hitting_lo; }, true),
    quantity_lines::stored(
        {quantity_lines::hitting, "hi", "", "nats", Better::more, "the upper end of that interval"},
        [](auto& e) -> auto& { return e.hitting.position.hitting_hi; }, true),
    quantity_lines::stored(
        {quantity_lines::hitting, "full", "", "nats", Better::more,
         "hitting in the full metric, with balls of 0.7 delta: a wrong heading does not score"},
        [](auto& e) -> auto& { return e.hitting.full.hitting; }, true, true),
    quantity_lines::stored(
        {quantity_lines::hitting, "full_lo", "", "nats", Better::more,
         "the lower end of Student's 95 % interval of hitting.full over runs"},
        [](auto& e) -> auto& { return e.hitting.full.hitting_lo; }, true),
    quantity_lines::stored(
        {quantity_lines::hitting, "full_hi", "", "nats", Better::more, "the upper end of that interval"},
        [](auto& e) -> auto& { return e.hitting.full.hitting_hi; }, true),
    quantity_lines::stored(
        {quantity_lines::hitting, "N", "", "", Better::none, "samples that hitting counts, without those at the goal"},
        [](auto& e) -> auto& { return e.hitting.samples; }, true),
    quantity_lines::stored(
        {quantity_lines::bottleneck, "nats", "", "nats", Better::more,
         "the least log ratio of the share of these samples in a ball along the path to that of uniform samples, by "
         "position: where samples are rarest"},
        [](auto& e) -> auto& { return e.hitting.position.bottleneck; }, true, true),
    quantity_lines::stored(
        {quantity_lines::bottleneck, "lo", "", "nats", Better::more,
         "the lower end of the 95 % interval of bottleneck.nats, simultaneous over the balls (Clopper and Pearson)"},
        [](auto& e) -> auto& { return e.hitting.position.bottleneck_lo; }, true),
    quantity_lines::stored(
        {quantity_lines::bottleneck, "hi", "", "nats", Better::more, "the upper end of that interval"},
        [](auto& e) -> auto& { return e.hitting.position.bottleneck_hi; }, true),
    quantity_lines::stored(
        {quantity_lines::bottleneck, "at", "", "m", Better::none,
         "the place of bottleneck.nats: arc length along the path"},
        [](auto& e) -> auto& { return e.hitting.position.at; }, true, true),
    quantity_lines::stored(
        {quantity_lines::bottleneck, "length", "", "m", Better::none, "the length of that path"},
        [](auto& e) -> auto& { return e.hitting.length; }, true),
    quantity_lines::stored(
        {quantity_lines::bottleneck, "full", "", "nats", Better::more, "bottleneck.nats in the full metric"},
        [](auto& e) -> auto& { return e.hitting.full.bottleneck; }, true),
    quantity_lines::stored(
        {quantity_lines::bottleneck, "full_lo", "", "nats", Better::more,
         "the lower end of the 95 % interval of bottleneck.full"},
        [](auto& e) -> auto& { return e.hitting.full.bottleneck_lo; }, true),
    quantity_lines::stored(
        {quantity_lines::bottleneck, "full_hi", "", "nats", Better::more, "the upper end of that interval"},
        [](auto& e) -> auto& { return e.hitting.full.bottleneck_hi; }, true),
    quantity_lines::stored(
        {quantity_lines::bottleneck, "full_at", "", "m", Better::none,
         "the place of bottleneck.full: arc length along the path in the full metric"},
        [](auto& e) -> auto& { return e.hitting.full.at; }, true),
    quantity_lines::estimated(
        {"", "D", "D(T‖Q)", "nats", Better::less,
         "the divergence with nothing mixed in: infinite where a part of the target has no sample"},
        [](auto& e) -> auto& { return e.unregularised; }, true),
    quantity_lines::estimated(
        {"", "SE", "SE_T(Q)", "nats", Better::less,
         "sampling efficiency, the divergence of the samples with 5 % uniform ones mixed in, so that it is finite"},
        [](auto& e) -> auto& { return e.value; }, true, true),
    quantity_lines::estimated(
        {quantity_lines::parts, "mass", "", "nats", Better::less,
         "the part of SE that says how seldom a sample lies in the target. It is counted, and exact"},
        [](auto& e) -> auto& { return e.parts.mass; }, true, true),
    quantity_lines::estimated(
        {quantity_lines::parts, "spread", "", "nats", Better::less,
         "the rest of SE: how unevenly the samples in the target cover it"},
        [](auto& e) -> auto& { return e.parts.spread; }, true),
    quantity_lines::estimated(
        {quantity_lines::parts, "along", "", "nats", Better::less, "the part of the spread of SE along the path"},
        [](auto& e) -> auto& { return e.parts.along; }),
    quantity_lines::estimated(
        {quantity_lines::parts, "across", "", "nats", Better::less, "the part of the spread of SE across the path"},
        [](auto& e) -> auto& { return e.parts.across; }),
    quantity_lines::computed({quantity_lines::parts, "mass_lo", "", "nats", Better::less,
                              "the lower end of the 95 % interval of SE_parts.mass"},
                             quantity_lines::mass_lo),
    quantity_lines::computed({quantity_lines::parts, "mass_hi", "", "nats", Better::less,
                              "the upper end of the 95 % interval of SE_parts.mass"},
                             quantity_lines::mass_hi),
    quantity_lines::computed(
        {quantity_lines::parts, "spread_lo", "", "nats", Better::less,
         "the lower end of the interval of SE_parts.spread that follows from those of SE and of its mass: "
         "with 90 % at least"},
        [](const Efficiency& e) { return e.value_lo - std::min(quantity_lines::mass_hi(e), e.value_lo); }),
    quantity_lines::computed(
        {quantity_lines::parts, "spread_hi", "", "nats", Better::less, "the upper end of that interval"},
        [](const Efficiency& e) { return e.value_hi - std::min(quantity_lines::mass_lo(e), e.value_hi); }),
    quantity_lines::stored(
        {"", "SE_lo", "", "nats", Better::less,
         "the lower end of the 95 % interval of SE that the samples support: counting certifies it"},
        [](auto& e) -> auto& { return e.value_lo; }, true, true),
    quantity_lines::stored(
        {"", "SE_hi", "", "nats", Better::less,
         "the upper end of that interval, which allows for what so many samples cannot show"},
        [](auto& e) -> auto& { return e.value_hi; }, true, true),
    quantity_lines::stored(
        {"", "D_perfect", "", "nats", Better::none, "SE of perfect guidance, samples of the target itself"},
        [](auto& e) -> auto& { return e.perfect; }, true),
    quantity_lines::stored(
        {"", "D_uniform", "", "nats", Better::none, "the divergence of uniform sampling"},
        [](auto& e) -> auto& { return e.uniform; }, true, true),
    quantity_lines::estimated(
        {"", "above_uniform", "", "nats", Better::more, "nats above uniform sampling: D_uniform - SE"},
        [](auto& e) -> auto& { return e.above_uniform; }, true),
    quantity_lines::stored(
        {"", "D_mass", "-log Q(A)", "nats", Better::less, "-log of the share of the samples in the target"},
        [](auto& e) -> auto& { return e.mass; }),
    quantity_lines::stored(
        {"", "D_mass_lower95", "", "nats", Better::less,
         "the lower bound of D_mass with 95 % confidence (Clopper and Pearson), which D cannot be below"},
        [](auto& e) -> auto& { return e.mass_lower95; }, true),
    quantity_lines::stored(
        {"", "D_mass_lo", "", "nats", Better::less, "the lower end of the two-sided 95 % interval of D_mass"},
        [](auto& e) -> auto& { return e.mass_lo; }),
    quantity_lines::stored(
        {"", "D_mass_hi", "", "nats", Better::less,
         "the upper end of that interval; infinite where no sample lies in the target"},
        [](auto& e) -> auto& { return e.mass_hi; }),
    quantity_lines::stored(
        {"", "coverage", "", "share", Better::more, "share of the target within delta of a sample (full metric)"},
        [](auto& e) -> auto& { return e.coverage; }, true, true),
    quantity_lines::stored(
        {"", "free_share", "", "share", Better::none, "valid share of the tube"},
        [](auto& e) -> auto& { return e.free_share; }),
    quantity_lines::stored(
        {"along", "D", "", "nats", Better::less,
         "the divergence of where along the path the samples in the target lie"},
        [](auto& e) -> auto& { return e.along.divergence; }, true),
    quantity_lines::stored(
        {"along", "empty_share", "", "share", Better::less,
         "share of the target in parts of the path without a sample"},
        [](auto& e) -> auto& { return e.along.empty_share; }, true),
});

/// The place of a quantity in `measure_quantities`.
class MeasureIndex {
 public:
  /// Finds a quantity by its name, "SE_parts.mass". A name without a quantity does not compile.
  consteval MeasureIndex(const char* name) : at_(0) {  // NOLINT(google-explicit-constructor)
    while (!measure_quantities.at(at_).is(name)) ++at_;
  }
  /// \param quantity  one of `measure_quantities`
  explicit MeasureIndex(const MeasureQuantity& quantity)
      : at_(static_cast<std::size_t>(&quantity - measure_quantities.data())) {}
  [[nodiscard]] std::size_t at() const { return at_; }

 private:
  std::size_t at_;
};

/// Returns those of runs, in the order of documents and tables.
std::span<const RunQuantity> run_quantities();

/// Returns all quantities.
std::vector<Quantity> quantities();

/// Returns the meaning of a quantity with its unit and the better values: "nats, less is better: ...".
std::string described(const Quantity& quantity);

/// Returns the quantity with a name.
/// \throws Fault where there is none
Quantity quantity(std::string_view name);

}  // namespace trellis
