// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <trellis/measure/statistics.hpp>
#include <trellis/report/costs.hpp>

namespace trellis {

/// The parts of the measure that may predict a cost, in the order of all lists below.
inline constexpr std::array<const char*, 4> predictors = {"hitting", "mass", "spread", "SE"};

/// Two predictors whose correlations are compared: indices into `predictors`.
struct PredictorPair {
  std::size_t first;
  std::size_t second;
};
inline constexpr std::array<PredictorPair, 5> predictor_pairs = {{{0, 1}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// Whether strategies whose samples have more nats above uniform cost fewer validity checks.
struct CostCorrelation {
  /// A strategy with guides on a problem.
  struct Dot {
    std::size_t problem = 0;   ///< index into CostData::problems
    std::size_t strategy = 0;  ///< index into CostData::strategies
    /// Nats above uniform of the root's samples, by each predictor.
    std::array<double, predictors.size()> nats{};
    /// Median of the validity checks divided by the baseline's on the same seed.
    double ratio = std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<Dot> dots;
  std::size_t problems = 0;    ///< that have dots
  std::size_t strategies = 0;  ///< likewise
  std::size_t cross = 0;       ///< those whose nats are on the paths of other seeds; the others' are on each run's own
  /// Spearman's rank correlation of the nats with the ratios, within problems (group_rank_correlation()), with a 95 %
  /// interval; -1: the more nats, the fewer checks. n: the problems that count.
  std::array<Interval, predictors.size()> rho;
  std::array<Interval, predictor_pairs.size()> differences;  ///< rho of the first minus that of the second
};

/// Correlates the nats with the costs beside the baseline, over the strategies with guides that are no ablations and no
/// baseline themselves. On each problem the nats are on the paths of other seeds where any strategy has such; a
/// strategy in several documents has the mean over its runs. Omits strategies without a ratio or without nats, and
/// problems with fewer than three that are left. None for fewer than two problems.
/// \param proposals  whether the nats are those of the root's proposals, else of its nodes
std::optional<CostCorrelation> cost_correlation(const CostData& data, const std::string& baseline,
                                                bool proposals = false);

/// "-0.62 [-0.80, -0.41]"; "-" for a missing value, and no brackets without an interval.
std::string correlation_text(const Interval& rho);

/// Rows of cells of a table, the first of them its heading: each predictor, then the differences, "mass - SE"; the
/// correlations with the nats of the nodes and of the proposals. No rows where there is no correlation.
std::vector<std::array<std::string, 3>> correlation_rows(const CostData& data, const std::string& baseline);

/// Returns what is correlated and how, in sentences, without the numbers.
std::string correlation_explanation(const CostCorrelation& found, const std::string& baseline);

}  // namespace trellis
