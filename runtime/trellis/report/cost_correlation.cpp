// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/cost_correlation.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <trellis/measure/group_correlation.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

constexpr std::size_t least_strategies = 3;
constexpr std::size_t least_problems = 2;

using Nats = std::array<double, predictors.size()>;

/// The mean over the runs of all documents.
class MeanNats {
 public:
  void add(const CostData::Nats& one) {
    const Nats nats = {one.hitting, one.mass, one.spread, one.above};
    runs_ += one.runs;
    // The first is taken as it is: rounding must not make the picture of a document differ from that of its runs.
    const double share = static_cast<double>(one.runs) / static_cast<double>(runs_);
    for (std::size_t i = 0; i < nats.size(); ++i) mean_[i] += (nats[i] - mean_[i]) * share;
  }
  [[nodiscard]] const Nats& mean() const { return mean_; }

 private:
  std::size_t runs_ = 0;
  Nats mean_{};
};

/// The nats by problem and strategy, of the paths that the problem's strategies are compared on.
struct ChosenNats {
  std::set<std::size_t> cross;  ///< problems with the paths of other seeds
  std::map<std::pair<std::size_t, std::size_t>, MeanNats> of;
};

ChosenNats chosen_nats(const CostData& data, bool proposals) {
  ChosenNats chosen;
  for (const CostData::Nats& one : data.nats) {
    if (one.proposals == proposals && one.cross) chosen.cross.insert(one.problem);
  }
  for (const CostData::Nats& one : data.nats) {
    if (one.proposals != proposals || one.cross != chosen.cross.contains(one.problem)) continue;
    chosen.of[{one.problem, one.strategy}].add(one);
  }
  return chosen;
}

}  // namespace

std::optional<CostCorrelation> cost_correlation(const CostData& data, const std::string& baseline, bool proposals) {
  if (baseline.empty() || data.nats.empty()) return std::nullopt;
  const ChosenNats nats = chosen_nats(data, proposals);
  std::map<std::size_t, std::vector<CostCorrelation::Dot>> by_problem;
  for (const CostComparison& c : compare_costs(data, baseline)) {
    const CostData::Strategy& strategy = data.strategies[c.strategy];
    const auto found = nats.of.find({c.problem, c.strategy});
    if (strategy.ablation || cost_levels(strategy.text).size() < 2 || found == nats.of.end()) continue;
    if (std::isnan(c.checks.ratio.value)) continue;
    by_problem[c.problem].push_back({c.problem, c.strategy, found->second.mean(), c.checks.ratio.value});
  }
  std::erase_if(by_problem, [](const auto& entry) { return entry.second.size() < least_strategies; });
  if (by_problem.size() < least_problems) return std::nullopt;
  CostCorrelation result;
  result.problems = by_problem.size();
  std::array<std::vector<PairGroup>, predictors.size()> groups;
  for (const auto& [problem, dots] : by_problem) {
    result.cross += nats.cross.contains(problem) ? 1 : 0;
    result.dots.insert(result.dots.end(), dots.begin(), dots.end());
    for (std::size_t i = 0; i < predictors.size(); ++i) {
      PairGroup& group = groups[i].emplace_back();
      for (const CostCorrelation::Dot& dot : dots) {
        group.a.push_back(dot.nats[i]);
        group.b.push_back(dot.ratio);
      }
    }
  }
  std::set<std::size_t> strategies;
  for (const CostCorrelation::Dot& dot : result.dots) strategies.insert(dot.strategy);
  result.strategies = strategies.size();
  std::array<GroupCorrelation, predictors.size()> correlations;
  for (std::size_t i = 0; i < predictors.size(); ++i) {
    correlations[i] = group_rank_correlation(groups[i]);
    result.rho[i] = correlations[i].rho;
  }
  for (std::size_t i = 0; i < predictor_pairs.size(); ++i) {
    const auto& [first, second] = predictor_pairs[i];
    result.differences[i] = correlation_difference(correlations[first], correlations[second]);
  }
  return result;
}

std::string correlation_text(const Interval& rho) {
  constexpr int decimals = 2;
  if (std::isnan(rho.value)) return "-";
  std::string value = fixed(rho.value, decimals, true);
  if (std::isnan(rho.lo) || std::isnan(rho.hi)) return value;
  return fmt::format("{} [{}, {}]", value, fixed(rho.lo, decimals, true), fixed(rho.hi, decimals, true));
}

std::vector<std::array<std::string, 3>> correlation_rows(const CostData& data, const std::string& baseline) {
  const auto nodes = cost_correlation(data, baseline);
  if (!nodes) return {};
  const auto proposals = cost_correlation(data, baseline, true);
  std::vector<std::array<std::string, 3>> rows = {{"nats above uniform", "of the nodes", "of the proposals"}};
  for (std::size_t i = 0; i < predictors.size(); ++i) {
    rows.push_back(
        {predictors[i], correlation_text(nodes->rho[i]), proposals ? correlation_text(proposals->rho[i]) : "-"});
  }
  for (std::size_t i = 0; i < predictor_pairs.size(); ++i) {
    const auto& [first, second] = predictor_pairs[i];
    rows.push_back({fmt::format("{} - {}", predictors[first], predictors[second]),
                    correlation_text(nodes->differences[i]),
                    proposals ? correlation_text(proposals->differences[i]) : "-"});
  }
  return rows;
}

std::string correlation_explanation(const CostCorrelation& found, const std::string& baseline) {
  const std::string paths =
      found.cross == 0 ? "each run's own path"
      : found.cross == found.problems
          ? "other seeds' paths"
          : fmt::format("other seeds' paths in {} of {}, else its own", found.cross, plural(found.problems, "problem"));
  return fmt::format(
      "{} with guides on {}, {} of both: nats above uniform of the root on {}, the mean over the runs (mass + "
      "spread = SE; hitting: by as many samples of each strategy, on paths of its own), and validity checks divided by "
      "those of {} on the same seed, the median. Spearman's rank "
      "correlation within problems; -1: the more nats, the fewer checks.{}",
      plural_y(found.strategies, "strateg"), plural(found.problems, "problem"), plural(found.dots.size(), "pair"),
      paths, baseline,
      found.problems < least_groups_for_interval ? "" : " In brackets: 95 % bootstrap interval over the problems.");
}

}  // namespace trellis
