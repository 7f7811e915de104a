// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <dsl/command/case_file.hpp>
#include <trellis/base/configurations.hpp>
#include <trellis/measure/efficiency.hpp>

namespace trellis::command {

/// The scores of samples that any program drew: `trellis measure` prints them, and the Python package returns them.
struct Measurement {
  /// The result of one estimator for the samples.
  struct Answer {
    std::string estimator;
    std::optional<Estimate> estimate;
    std::string reason;  ///< why it has no value
  };
  Efficiency headline;
  std::vector<Answer> answers;  ///< of all estimators; empty unless the user requests all
  double log_volume = 0.0;      ///< log|T|
  std::size_t outside = 0;      ///< samples outside of the space
  std::vector<std::string> notes;
};

/// Returns the estimators of a request.
/// \param asked    a name, "all", or "" for the default in a space with so many degrees of freedom
/// \throws Error for an unknown estimator, and for one that samples alone do not suffice for
std::vector<EstimatorSpec> measure_estimators(const std::string& asked, std::size_t degrees);

/// Scores samples against the path of a case.
/// \throws Error if there are no samples, no target, or no value from the first estimator.
Measurement measure_samples(const Case& c, Configurations samples, const std::vector<EstimatorSpec>& specs);

/// Returns the JSON document of `trellis measure --json` (docs/formats.md).
std::string measurement_json(const Case& c, const Measurement& m);
/// Returns the printed table.
std::string measurement_table(const Case& c, const Measurement& m);

}  // namespace trellis::command
