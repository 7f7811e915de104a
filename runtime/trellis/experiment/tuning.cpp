// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/tuning.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/measure/statistics.hpp>

namespace trellis {

namespace {

constexpr std::uint64_t least_seeds = 2;        // of the first round
constexpr std::uint64_t least_evaluation = 10;  // pairs on held-out seeds
constexpr std::uint64_t evaluated_share = 4;    // a quarter of the budget is for held-out seeds
constexpr double significant = 0.05;

/// The runs of all rounds for each problem, per seed of the first round. Round r has half of the strategies of the
/// round before, and twice its seeds; the runs on the seeds before are kept.
std::uint64_t runs_per_seed(std::size_t strategies) {
  std::uint64_t runs = strategies;
  std::uint64_t new_seeds = 1;
  for (std::size_t n = (strategies + 1) / 2; n > 1; n = (n + 1) / 2) {
    runs += n * new_seeds;
    new_seeds *= 2;
  }
  return runs;
}

std::uint64_t least_held_out(std::size_t problems) { return (least_evaluation + problems - 1) / problems; }

/// Returns the seeds of the first round.
std::uint64_t first_seeds(std::size_t strategies, std::size_t problems, std::uint64_t budget) {
  const std::uint64_t evaluation = std::max(2 * problems * least_held_out(problems), budget / evaluated_share);
  const std::uint64_t rest = budget > evaluation ? budget - evaluation : 0;
  return std::max(least_seeds, rest / (problems * runs_per_seed(strategies)));
}

CensoredCost cost_of(const RunResult& run, TuneBy by) {
  switch (by) {
    case TuneBy::checks: return {static_cast<double>(run.run.validity_checks), run.run.solved};
    case TuneBy::time: return {run.cpu_seconds, run.run.solved};
    case TuneBy::length: return {run.run.length, run.run.solved};
  }
  throw Fault("unknown cost of a tuning");
}

/// The costs of each strategy in the order of seeds, then problems. So all strategies have the same runs first.
class Tuner {
 public:
  Tuner(const Experiment& experiment, const TuneSettings& settings, const ExperimentOptions& options)
      : experiment_(experiment), settings_(settings), options_(options), costs_(experiment.strategies.size()) {
    experiment_.measure.reset();
    experiment_.ablations.clear();
    experiment_.ablation = 0.0;
    experiment_.baseline.clear();
  }

  TuneResult run() {
    const std::size_t problems = experiment_.problems.size();
    result_.strategies.resize(costs_.size());
    std::vector<std::size_t> kept(costs_.size());
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = i;
    std::uint64_t seeds = first_seeds(costs_.size(), problems, settings_.budget);
    std::uint64_t done = 0;
    while (kept.size() > 1) {
      plan(kept, done, seeds);
      done = seeds;
      seeds *= 2;
      select(kept);
    }
    result_.winner = kept.front();
    result_.strategies[result_.winner].end = TunedStrategy::End::best;
    result_.seeds = seeds_from(0, done);
    compare();
    if (result_.winner != 0) evaluate(done);
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::vector<std::uint64_t> seeds_from(std::uint64_t first, std::uint64_t last) const {
    std::vector<std::uint64_t> seeds;
    for (std::uint64_t i = first; i < last; ++i) seeds.push_back(settings_.seed + i);
    return seeds;
  }

  /// Runs the strategies on the seeds [first, last), and returns their costs.
  std::vector<std::vector<CensoredCost>> costs_on(const std::vector<std::size_t>& strategies, std::uint64_t first,
                                                  std::uint64_t last) {
    Experiment round = experiment_;
    round.strategies.clear();
    for (const std::size_t i : strategies) round.strategies.push_back(experiment_.strategies[i]);
    round.seeds = seeds_from(first, last);
    ExperimentOptions options = options_;
    if (options_.progress) {
      options.progress = [this](std::size_t done, std::size_t) {
        options_.progress(result_.runs + done, std::max<std::uint64_t>(settings_.budget, result_.runs + done));
      };
    }
    const ExperimentResult runs = trellis::run(round, options);
    result_.runs += runs.runs.size();
    // The runs are in the order of problems, strategies and seeds.
    const std::size_t n = strategies.size();
    const std::size_t count = round.seeds.size();
    std::vector<std::vector<CensoredCost>> costs(n);
    for (std::size_t seed = 0; seed < count; ++seed) {
      for (std::size_t problem = 0; problem < round.problems.size(); ++problem) {
        for (std::size_t s = 0; s < n; ++s) {
          costs[s].push_back(cost_of(runs.runs[(problem * n + s) * count + seed], settings_.by));
        }
      }
    }
    return costs;
  }

  void plan(const std::vector<std::size_t>& kept, std::uint64_t first, std::uint64_t last) {
    const auto costs = costs_on(kept, first, last);
    for (std::size_t k = 0; k < kept.size(); ++k) {
      costs_[kept[k]].insert(costs_[kept[k]].end(), costs[k].begin(), costs[k].end());
      TunedStrategy& strategy = result_.strategies[kept[k]];
      ++strategy.rounds;
      strategy.seeds = last;
      strategy.runs = costs_[kept[k]].size();
      strategy.solved = static_cast<std::size_t>(std::count_if(costs_[kept[k]].begin(), costs_[kept[k]].end(),
                                                               [](const CensoredCost& cost) { return cost.solved; }));
    }
  }

  /// The median over the runs of the ratio to the least cost of any of the strategies.
  [[nodiscard]] double rank_of(std::size_t strategy, const std::vector<CensoredCost>& least) const {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < least.size(); ++i) ratios.push_back(cost_ratio(costs_[strategy][i], least[i]));
    return median(ratios);
  }

  /// Keeps the better half, without the rejected ones.
  void select(std::vector<std::size_t>& kept) {
    std::vector<CensoredCost> least(costs_[kept.front()].size(), CensoredCost{0.0, false});
    for (const std::size_t strategy : kept) {
      for (std::size_t i = 0; i < least.size(); ++i) {
        const CensoredCost& cost = costs_[strategy][i];
        if (cost.cost() < least[i].cost()) least[i] = cost;
      }
    }
    struct Ranked {
      double ratio;
      std::size_t unsolved;
      std::size_t strategy;
    };
    std::vector<Ranked> ranked;
    ranked.reserve(kept.size());
    for (const std::size_t strategy : kept) {
      const TunedStrategy& known = result_.strategies[strategy];
      ranked.push_back({rank_of(strategy, least), known.runs - known.solved, strategy});
    }
    std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
      return std::tie(a.ratio, a.unsolved, a.strategy) < std::tie(b.ratio, b.unsolved, b.strategy);
    });
    ranked.resize((kept.size() + 1) / 2);
    kept.clear();
    for (const Ranked& one : ranked) kept.push_back(one.strategy);
    reject(kept);
    std::sort(kept.begin(), kept.end());
  }

  /// Removes those that a paired test rejects in comparison with the first.
  void reject(std::vector<std::size_t>& kept) {
    std::vector<PairedCosts> pairs;
    std::vector<double> p;
    for (std::size_t k = 1; k < kept.size(); ++k) {
      pairs.push_back(paired_costs(costs_[kept[k]], costs_[kept.front()]));
      p.push_back(pairs.back().sign_p);
    }
    p = holm(p);
    std::vector<std::size_t> rest = {kept.front()};
    for (std::size_t k = 1; k < kept.size(); ++k) {
      const PairedCosts& pair = pairs[k - 1];
      if (p[k - 1] < significant && pair.greater > pair.less) {
        result_.strategies[kept[k]].end = TunedStrategy::End::rejected;
      } else {
        rest.push_back(kept[k]);
      }
    }
    kept = std::move(rest);
  }

  /// Compares each strategy with the winner and with the first one, on their common runs.
  void compare() {
    const auto pairs_of = [&](std::size_t mine, std::size_t other) {
      const std::size_t n = std::min(costs_[mine].size(), costs_[other].size());
      return paired_costs(std::span(costs_[mine]).first(n), std::span(costs_[other]).first(n));
    };
    std::vector<double> p;
    for (std::size_t i = 0; i < costs_.size(); ++i) {
      result_.strategies[i].to_start = pairs_of(i, 0);
      result_.strategies[i].to_winner = pairs_of(i, result_.winner);
      p.push_back(i == result_.winner ? std::numeric_limits<double>::quiet_NaN()
                                      : result_.strategies[i].to_winner.sign_p);
    }
    p = holm(p);
    for (std::size_t i = 0; i < costs_.size(); ++i) {
      if (i != result_.winner) result_.strategies[i].to_winner.holm_p = p[i];
    }
  }

  /// Spends the rest of the budget on new seeds.
  void evaluate(std::uint64_t first) {
    const std::size_t problems = experiment_.problems.size();
    const std::uint64_t rest = settings_.budget > result_.runs ? settings_.budget - result_.runs : 0;
    const std::uint64_t seeds = std::max(least_held_out(problems), rest / (2 * problems));
    result_.held_out = seeds_from(first, first + seeds);
    const auto costs = costs_on({result_.winner, 0}, first, first + seeds);
    result_.evaluation = paired_costs(costs[0], costs[1]);
  }

  Experiment experiment_;
  TuneSettings settings_;
  const ExperimentOptions& options_;
  std::vector<std::vector<CensoredCost>> costs_;
  TuneResult result_;
};

}  // namespace

std::string_view to_string(TuneBy by) {
  switch (by) {
    case TuneBy::checks: return "validity checks";
    case TuneBy::time: return "CPU time";
    case TuneBy::length: return "path length";
  }
  throw Fault("unknown cost of a tuning");
}

std::uint64_t least_tune_budget(std::size_t strategies, std::size_t problems) {
  return problems * (least_seeds * runs_per_seed(strategies) + 2 * least_held_out(problems));
}

TuneResult tune(const Experiment& experiment, const TuneSettings& settings, const ExperimentOptions& options) {
  const std::size_t strategies = experiment.strategies.size();
  const std::size_t problems = experiment.problems.size();
  if (strategies < 2) throw Error(fmt::format("tune: it selects from two strategies at least, got {}", strategies));
  if (problems == 0) throw Error("tune: no problem given");
  const std::uint64_t least = least_tune_budget(strategies, problems);
  if (settings.budget < least) {
    throw Error(fmt::format("tune: a budget of {} runs is too small: {} strategies on {} problem{} require at least {}",
                            settings.budget, strategies, problems, problems == 1 ? "" : "s", least));
  }
  return Tuner(experiment, settings, options).run();
}

}  // namespace trellis
