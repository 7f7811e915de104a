// SPDX-License-Identifier: GPL-3.0-or-later
// A figure of each run held against a criterion by its median, for the matchers of this folder.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/trial/criterion.hpp>
#include <trellis/trial/matcher.hpp>

namespace trellis::trial {

/// The figure of a run, NaN where it has none.
using FigureOf = std::function<double(const RunResult&)>;

/// The runs of both trials that have the same seed. Throws Error for trials on different problems or seeds.
struct Pair {
  const RunResult* mine;
  const RunResult* others;
};
std::vector<Pair> pairs_of(const std::vector<RunResult>& mine, const Trial& trial, const std::vector<RunResult>& others,
                           const Trial& other);

/// How figures are put into words.
struct MedianWords {
  std::string verb;  ///< "spent"
  std::string noun;  ///< "validity checks"
  int decimals = 0;
};

/// Against a number: the bound of the median of the figures. A run without a path counts as infinitely much where less
/// is better.
Verdict judge_median(const Criterion& criterion, const std::vector<RunResult>& runs, const FigureOf& figure,
                     const MedianWords& words);

/// Against another trial: the bound of the median of the ratios, each run's figure to that of the same seed there, by
/// the rule of measure/censored_cost.hpp on the side of what is claimed. A pair without a figure is left out.
Verdict judge_ratio(const Criterion& criterion, const std::vector<Pair>& pairs, const FigureOf& figure,
                    const FigureOf& others, const MedianWords& words);

}  // namespace trellis::trial
