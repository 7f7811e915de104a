// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/unused.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

namespace trellis {

namespace {

/// One source of the guidance of one level, over all runs of a strategy.
struct Part {
  std::string path;  ///< of the guided level
  std::string name;
  std::size_t drawn = 0;
  std::size_t entered = 0;
  std::size_t proposals = 0;  ///< of the level, from all sources
};

/// Returns the position of a component in the script; "" where it is not recorded. Two components with equal text share
/// a position.
std::string origin_of(const GuideSpec& guide, const std::string& text) {
  if (guide.kind() == GuideSpec::Kind::component) {
    if (guide.alone().text() == text && !guide.origin().script.empty()) {
      return fmt::format("{}:{}: ", guide.origin().script, guide.origin().line);
    }
    return guide.below() != nullptr ? origin_of(*guide.below(), text) : "";
  }
  for (const auto& term : guide.terms()) {
    std::string origin = origin_of(term.guide, text);
    if (!origin.empty()) return origin;
  }
  return "";
}

using Parts = std::map<std::pair<std::string, std::size_t>, Part>;  // by level and source

void count(const RunResult& run, Parts& parts) {
  const auto at = [&](int i) -> const LevelRecord& { return run.levels[static_cast<std::size_t>(i)].record; };
  constexpr std::size_t own = 3;  // the sources before a guide's: goal, uniform, informed path
  for (const LevelResult& level : run.levels) {
    const Search& search = level.record.search;
    // The guide of an explicit graph lowers the cost of edges; it adds no samples.
    if (find_planner(level.record.planner)->graph) continue;
    for (std::size_t source = own; source < search.sources.size(); ++source) {
      Part& part = parts[{level.record.key, source}];
      if (part.path.empty()) part = {level_path(level.record, at), search.sources[source]};
      part.proposals += search.proposals.size();
    }
    for (std::size_t i = 0; i < search.proposal_sources.size(); ++i) {
      if (search.proposal_sources[i] < own) continue;
      Part& part = parts[{level.record.key, search.proposal_sources[i]}];
      ++part.drawn;
      part.entered += search.added[i] != no_node ? 1 : 0;
    }
  }
}

}  // namespace

std::vector<std::string> unused_guides(const Experiment& experiment, const ExperimentResult& result) {
  constexpr std::size_t few = 20;  // proposals that may all fail without a reason
  std::vector<std::string> sentences;
  for (const auto& [name, strategy] : experiment.strategies) {
    const bool ablated = std::any_of(experiment.ablations.begin(), experiment.ablations.end(),
                                     [&, &taken = name](const AblationLink& link) { return link.strategy == taken; });
    if (ablated || strategy.guide() == nullptr) continue;
    Parts parts;
    std::size_t runs = 0;
    bool solved = false;
    for (const RunResult& run : result.runs) {
      if (run.strategy != name) continue;
      ++runs;
      solved = solved || run.run.solved;
      count(run, parts);
    }
    const std::string over = runs == 1 ? "one run" : fmt::format("{} runs", runs);
    for (const auto& [key, part] : parts) {
      const std::string of =
          fmt::format("{}strategy '{}', {}: ", origin_of(*strategy.guide(), part.name), name, part.path);
      if (part.drawn >= few && part.entered == 0) {
        sentences.push_back(fmt::format("{}{} drew {} proposals in {}, and none of them entered the tree", of,
                                        part.name, part.drawn, over));
      } else if (part.drawn == 0 && part.proposals >= few && !solved) {
        sentences.push_back(
            fmt::format("{}{} drew none of the {} proposals in {}", of, part.name, part.proposals, over));
      }
    }
  }
  return sentences;
}

}  // namespace trellis
