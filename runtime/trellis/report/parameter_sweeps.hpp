// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/report/costs.hpp>

namespace trellis {

/// Strategies that differ in one number of one option.
struct ParameterCurve {
  std::string name;                     ///< their text, with the option's name instead of the number
  std::vector<double> values;           ///< of the option, ascending
  std::vector<std::size_t> strategies;  ///< of each value: an index into CostData::strategies
};

/// All such curves over one option.
struct ParameterSweep {
  std::string option;  ///< "scale of shrink"
  std::vector<ParameterCurve> curves;

  [[nodiscard]] bool has(std::size_t strategy) const;
};

/// Finds the sweeps among strategies: curves of at least three values. A strategy of a grid of two options belongs to
/// two sweeps.
std::vector<ParameterSweep> parameter_sweeps(const CostData& data);

}  // namespace trellis
