// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/tuning.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <trellis/report/views/table.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

constexpr double significant = 0.05;

/// A ratio with its interval, where the pairs are enough for one.
std::string paired_text(const PairedCosts& pairs) {
  Interval ratio = pairs.ratio;
  // The interval of few pairs has no bound.
  if (!(ratio.lo > 0.0) && !std::isfinite(ratio.hi)) ratio.lo = std::numeric_limits<double>::quiet_NaN();
  return ratio_text(ratio);
}

std::string end_text(const TunedStrategy& strategy) {
  switch (strategy.end) {
    case TunedStrategy::End::best: return "best";
    case TunedStrategy::End::halved: return fmt::format("round {}, half", strategy.rounds);
    case TunedStrategy::End::rejected: return fmt::format("round {}, test", strategy.rounds);
  }
  return "";
}

/// The winner first, then those that were removed last.
std::vector<std::size_t> order_of(const TuneResult& result) {
  std::vector<std::size_t> order(result.strategies.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto removed = [&](std::size_t i) {
    const TunedStrategy& strategy = result.strategies[i];
    return strategy.end == TunedStrategy::End::best ? result.strategies.front().rounds + order.size() : strategy.rounds;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (removed(a) != removed(b)) return removed(a) > removed(b);
    return result.strategies[a].to_winner.ratio.value < result.strategies[b].to_winner.ratio.value;
  });
  return order;
}

std::string table_text(const Experiment& experiment, const TuneResult& result, std::size_t width) {
  Table table({{{"strategy"}, "", true},
               {{"seeds"}, "", false},
               {{"solved"}, "", false},
               {{"ratio to", "the winner"}, "", true},
               {{"ratio to", "the start"}, "", true},
               {{"removed"}, "", true}});
  for (const std::size_t i : order_of(result)) {
    const TunedStrategy& strategy = result.strategies[i];
    table.add({experiment.strategies[i].first + (i == 0 ? " (start)" : ""), std::to_string(strategy.seeds),
               fmt::format("{}/{}", strategy.solved, strategy.runs),
               i == result.winner ? "1" : paired_text(strategy.to_winner),
               i == 0 ? "1" : paired_text(strategy.to_start), end_text(strategy)});
  }
  return table.text(width);
}

std::string evaluation_text(const Experiment& experiment, const TuneSettings& settings, const TuneResult& result) {
  if (result.winner == 0) return "the start is the best of these; nothing was run on held-out seeds";
  const PairedCosts& pairs = result.evaluation;
  return fmt::format(
      "on {} that nothing was selected on, the winner has {} times the {} of the start ({}); less in "
      "{} of {}, p {}; it solved {} runs, the start {}",
      seeds_text(result.held_out), paired_text(pairs), to_string(settings.by), experiment.strategies.front().first,
      pairs.less, plural(pairs.pairs, "run"), p_text(pairs.sign_p), pairs.solved, pairs.reference_solved);
}

/// The strategies that the paired tests do not distinguish from the winner.
std::string alike_text(const Experiment& experiment, const TuneResult& result) {
  std::vector<std::string> alike;
  for (const std::size_t i : order_of(result)) {
    if (i != result.winner && result.strategies[i].to_winner.holm_p >= significant) {
      alike.push_back(experiment.strategies[i].first);
    }
  }
  if (alike.empty()) return "every other strategy costs more than the winner, at p < 0.05 with Holm's correction";
  constexpr std::size_t most = 3;
  const std::size_t others = alike.size() > most ? alike.size() - most : 0;
  alike.resize(alike.size() - others);
  return fmt::format("not shown to differ from the winner (paired sign tests with Holm's correction): {}{}",
                     fmt::join(alike, "; "), others > 0 ? fmt::format("; and {} more", others) : "");
}

}  // namespace

std::string tuning_text(const Experiment& experiment, const TuneSettings& settings, const TuneResult& result,
                        std::size_t width) {
  const auto& [values, winner] = experiment.strategies[result.winner];
  std::string out = wrap(fmt::format("{} on {} by {}: {} of at most {}, selected on {}",
                                     fmt::format("{} strategies", experiment.strategies.size()),
                                     plural(experiment.problems.size(), "problem"), to_string(settings.by),
                                     plural(result.runs, "run"), settings.budget, seeds_text(result.seeds)),
                         width);
  if (settings.by == TuneBy::time) {
    out += wrap("CPU time differs from run to run of this command; tune by checks is deterministic", width);
  }
  out += '\n' + table_text(experiment, result, width) + '\n';
  out += wrap(
      "ratios: medians over the common runs, with 95 % intervals where the runs are enough; an unsolved run "
      "costs infinitely much",
      width);
  out += wrap(alike_text(experiment, result), width);
  out += wrap(evaluation_text(experiment, settings, result), width);
  return out + fmt::format("\n-- {}\n{}\n", values, winner.text());
}

}  // namespace trellis
