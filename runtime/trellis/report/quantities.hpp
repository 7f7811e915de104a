// SPDX-License-Identifier: GPL-3.0-or-later
// The quantities that results have. Documents, tables in CSV, `trellis measure`, help and the glossary use these lists.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <trellis/experiment/facts.hpp>
#include <trellis/report/summary.hpp>

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

  /// The one name of it, in JSON, CSV and help: "D_eps", "D_eps_parts.mass".
  [[nodiscard]] std::string name() const { return *group == '\0' ? key : std::string(group) + '.' + key; }
};

/// One quantity of the measure: where a run has it, and where a summary has its interval.
struct MeasureQuantity : Quantity {
  double (*of_run)(const Efficiency&);
  double& (*field)(Efficiency&);  ///< where a run stores it; nullptr: computed from others
  Interval Figure::*over_runs;    ///< nullptr: summaries do not have it
  bool of_estimate;               ///< whether each estimator has one
  bool in_table;                  ///< whether tables of runs have a column of it
};

/// One number of a run.
struct RunQuantity : Quantity {
  std::variant<double RunTotals::*, std::uint64_t RunTotals::*> field;
  bool clock = false;  ///< a time that no two runs share
};

/// Returns those of the measure, in the order of reports; those of a group follow one another.
std::span<const MeasureQuantity> measure_quantities();

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
