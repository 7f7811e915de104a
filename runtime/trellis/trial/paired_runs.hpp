// SPDX-License-Identifier: GPL-3.0-or-later
// Compares a statistic of each run with a criterion by the median, for the matchers of this folder.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/trial/criterion.hpp>
#include <trellis/trial/matcher.hpp>

namespace trellis::trial {

/// Returns the value of a run, NaN where it has none.
using FigureOf = std::function<double(const RunResult&)>;

/// Returns the runs of both trials with equal seeds.
/// \throws Error for trials on different problems or seeds.
struct Pair {
  const RunResult* mine;
  const RunResult* others;
};
std::vector<Pair> pairs_of(const std::vector<RunResult>& mine, const Trial& trial, const std::vector<RunResult>& others,
                           const Trial& other);

/// The words of a message about the median.
struct MedianWords {
  std::string verb;  ///< "spent"
  std::string noun;  ///< "validity checks"
  int decimals = 0;
};

/// Against a number: uses the confidence bound of the median of the values. A run without a path counts as infinite
/// where less is better.
Verdict judge_median(const Criterion& criterion, const std::vector<RunResult>& runs, const FigureOf& figure,
                     const MedianWords& words);

/// Against another trial: uses the confidence bound of the median of the ratios, each run's value to that of the same
/// seed there. Censored runs follow the rule of measure/censored_cost.hpp, on the conservative side. Omits pairs
/// without a value.
Verdict judge_ratio(const Criterion& criterion, const std::vector<Pair>& pairs, const FigureOf& figure,
                    const FigureOf& others, const MedianWords& words);

}  // namespace trellis::trial
