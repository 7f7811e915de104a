// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/repl/run.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/scoring.hpp>
#include <trellis/results/records.hpp>

namespace trellis::command {

namespace {

std::string counted(std::uint64_t n, const std::string& noun) {
  return fmt::format("{} {}{}", n, noun, n == 1 ? "" : "s");
}

std::string text_of(View q) {
  std::vector<std::string> coordinates;
  coordinates.reserve(q.size());
  for (const double x : q) coordinates.push_back(fmt::format("{:.3g}", x));
  return fmt::format("({})", fmt::join(coordinates, ", "));
}

/// Returns the number of edges from the root of its tree to a node; none without a tree.
std::optional<std::size_t> depth_of(const Search& search, std::uint32_t node) {
  std::size_t depth = 0;
  while (node < search.parents.size() && search.parents[node] != no_node) {
    if (search.parents[node] == node) return depth;
    node = search.parents[node];
    ++depth;
  }
  return {};
}

/// Describes the outcome of a proposal, and the node that it extended, in a line each.
std::string fate_text(const LevelRecord& record, std::size_t row) {
  const Search& search = record.search;
  const Fate fate = row < search.fates.size() ? search.fates[row] : Fate::rejected;
  const std::uint32_t near = row < search.near.size() ? search.near[row] : no_node;
  const std::uint32_t added = row < search.added.size() ? search.added[row] : no_node;
  std::string text = "  became    ";
  if (fate != Fate::rejected && added != no_node) {
    text += fmt::format("node {} at {}{}\n", added, text_of(search.nodes[added]),
                        fate == Fate::reached ? ", the proposal itself" : ", a step towards it");
  } else if (fate != Fate::rejected) {
    text += "no node: it makes the edges near it cheaper\n";
  } else {
    const bool there = near != no_node && record.space.distance(search.nodes[near], search.proposals[row]) == 0.0;
    text += near == no_node ? "no node: it is invalid, or there already\n"
            : there         ? "no node: it is there already\n"
                            : "no node: the motion to it is blocked\n";
  }
  if (near == no_node) return text;
  const View end = added != no_node ? search.nodes[added] : search.proposals[row];
  text += fmt::format("  from      node {} at {}, {:.3g} m away", near, text_of(search.nodes[near]),
                      record.space.distance(search.nodes[near], end));
  if (const auto depth = depth_of(search, near)) text += fmt::format(", {} from the root", counted(*depth, "edge"));
  return text + "\n";
}

}  // namespace

const RunResult& Run::result() const {
  if (!known) known = make_cell(strategy_name, problem.name, seed, execution->record());
  return *known;
}

void advance(Run& run, std::uint64_t proposals, const std::function<bool()>& interrupted) {
  if (!run.execution) {
    ExecuteOptions options;
    options.watch = [&run](const LevelRecord& level, const Guidance&) {
      ++run.proposals;
      run.last = {level.level, level.search.proposals.size() - 1};
    };
    run.execution = std::make_unique<Execution>(run.strategy, run.problem, run.seed, options);
  }
  run.known.reset();
  run.scored = false;
  if (!run.execution->advance([&] { return run.proposals >= proposals || (interrupted && interrupted()); })) return;
  const RunResult& result = run.result();
  run.execution.reset();
  check_unused_guides(run.strategy, run.problem, result.run);
  if (!run.last || run.last->level >= 0) return;
  // The record of level 0 ends with the proposals of the unguided planner.
  const std::size_t all = result.levels.front().record.search.proposals.size();
  run.last = {0, all - result.run.bounded.unguided_proposals + run.last->row};
}

void score(Run& run, const Measure& measure, const std::function<bool()>& interrupted) {
  Experiment experiment;
  experiment.problems = {run.problem};
  experiment.strategies = {{run.strategy_name, run.strategy}};
  experiment.seeds = {run.seed};
  experiment.measure = measure;
  experiment.measure->cross = 0;
  check(experiment);
  ExperimentResult result;
  result.runs = {run.result()};
  trellis::score(
      experiment, result, 0, [] {}, interrupted);
  run.known = std::move(result.runs.front());
  run.scored = true;
}

std::string outcome_text(const Run& run) {
  const RunRecord& record = run.result().run;
  std::string text =
      fmt::format("run {} on {}: {}, seed {}: ", run.number, run.problem.name, run.strategy_name, run.seed);
  const std::string cost =
      fmt::format("{} and {} in {:.{}f} ms", counted(run.proposals, "proposal"),
                  counted(record.validity_checks, "check"), 1000.0 * record.seconds, record.seconds < 0.01 ? 1 : 0);
  if (!run.ended()) return text + "stopped after " + cost;
  const double seconds = record.trajectory.duration();
  const std::string driven = seconds > 0.0 ? fmt::format(", driven in {:.1f} s", seconds) : "";
  if (record.solved) {
    return text + fmt::format("solved by {}, a certified path of {:.2f} m{}", cost, record.length, driven);
  }
  return text + fmt::format("not solved ({}) by {}", to_string(record.status), cost);
}

std::size_t level_at_work(const Run& run) {
  return run.last && !run.ended() ? static_cast<std::size_t>(std::max(run.last->level, 0)) : 0;
}

std::string where_text(const Run& run) {
  std::string end;
  if (run.ended()) {
    const RunRecord& record = run.result().run;
    end =
        fmt::format("the run has ended: {}\n", record.solved ? fmt::format("solved, a path of {:.2f} m", record.length)
                                                             : fmt::format("not solved, {}", to_string(record.status)));
  }
  if (!run.last) return "nothing has been proposed yet\n" + end;
  // A record of all samples would take longer than a step.
  const auto record_of = [&](int number) -> const LevelRecord& {
    if (number < 0) return *run.execution->companion();
    const auto level = static_cast<std::size_t>(number);
    return run.ended() ? run.result().levels.at(level).record : run.execution->level(level);
  };
  const LevelRecord& level = record_of(run.last->level);
  const Search& search = level.search;
  const std::size_t row = run.last->row;
  const Guidance::Source source = search.proposal_sources[row];
  const std::string name =
      level.level < 0 ? "level 0 without guides" : fmt::format("level {}, {}", level.level, level.name);
  std::string text = fmt::format("proposal {} of the run, number {} of {}, searched by {}\n", run.proposals, row + 1,
                                 name, level.planner);
  const View q = search.proposals[row];
  text += fmt::format("  proposed  {} by {}\n", text_of(q),
                      source < search.sources.size() ? search.sources[source] : "an unknown part of h");
  text += fate_text(level, row);
  const std::uint64_t solves = run.ended() ? level.solves : level.solves + 1;
  text += fmt::format("  so far    {}, {}", counted(search.nodes.size(), "node"),
                      !run.ended()  ? fmt::format("in solve {}", solves)
                      : solves == 1 ? "solved once"
                                    : fmt::format("solved {} times", solves));
  std::string waiting;
  for (int at = level.parent; at >= 0; at = record_of(at).parent) {
    waiting += fmt::format("{}level {}, {}", waiting.empty() ? "" : ", ", at, record_of(at).name);
  }
  if (!waiting.empty()) text += "; above it: " + waiting;
  return text + "\n" + end;
}

namespace {

using Json = nlohmann::json;

Json read_json(const std::string& text, const std::string& path) {
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    throw Error(fmt::format("replay: '{}' is no JSON document: {}", path, error.what()));
  }
}

/// Finds the script that a document names, relative to the current folder or to the document's folder.
std::string find_script(const std::string& document, const std::string& script) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  for (const fs::path& place : {fs::path(script), fs::path(document).parent_path() / script}) {
    if (fs::is_regular_file(place, ignored)) return place.string();
  }
  throw Error(
      fmt::format("replay: '{}' was made by the script '{}', which is neither there nor beside the document; "
                  "the worlds of its problems are in the script alone",
                  document, script));
}

/// Returns the first difference between the document's run and a new one.
std::string difference_text(const RunFacts& stored, const RunResult& run) {
  const auto differ = [](const std::string& what, const auto& x, const auto& y) {
    return fmt::format("{}: {} in the document, {} now", what, x, y);
  };
  if (stored.status != run.run.status) return differ("status", to_string(stored.status), to_string(run.run.status));
  if (stored.validity_checks != run.run.validity_checks) {
    return differ("validity checks", stored.validity_checks, run.run.validity_checks);
  }
  // With shortcutting, the document's path differs from that of the search.
  if (stored.shortcut_checks == 0) {
    const Configurations found = run.run.solved ? run.run.path : Configurations();
    bool same = stored.path.size() == found.size();
    for (std::size_t i = 0; same && i < found.size(); ++i) {
      same = std::equal(stored.path[i].begin(), stored.path[i].end(), found[i].begin(), found[i].end());
    }
    if (!same) return "the paths differ";
  }
  if (stored.levels.size() != run.levels.size()) return differ("levels", stored.levels.size(), run.levels.size());
  for (std::size_t i = 0; i < stored.levels.size(); ++i) {
    const Search& search = run.levels[i].record.search;
    const LevelFacts& level = stored.levels[i];
    if (level.proposals != search.proposals.size()) {
      return differ(fmt::format("proposals of level {}", i), level.proposals, search.proposals.size());
    }
    if (level.nodes != search.nodes.size()) {
      return differ(fmt::format("nodes of level {}", i), level.nodes, search.nodes.size());
    }
  }
  return "";
}

Replayed replay_entry(const Json& document, const std::vector<RunFacts>& runs, const std::string& path,
                      std::int64_t index, const std::function<bool()>& interrupted) {
  if (index < 1 || static_cast<std::size_t>(index) > runs.size()) {
    throw Error(fmt::format("replay: '{}' has the runs 1 to {}, got {}", path, runs.size(), index));
  }
  const RunFacts& entry = runs[static_cast<std::size_t>(index) - 1];
  const std::string script = document.at("script");
  if (script.empty()) throw Error(fmt::format("replay: '{}' names no script that made it", path));
  const std::string found = find_script(path, script);
  dsl::Program program = dsl::load_script(found);
  const std::string problem_name = entry.problem;
  const std::string strategy_name = entry.strategy;
  Experiment& experiment = program.experiment;
  const auto named = [&](const auto& pair) { return pair.first == strategy_name; };
  auto strategy = std::find_if(experiment.strategies.begin(), experiment.strategies.end(), named);
  if (strategy == experiment.strategies.end()) {
    // The strategy may be an ablation that the command line added.
    dsl::ablate_all(experiment, "replay");
    strategy = std::find_if(experiment.strategies.begin(), experiment.strategies.end(), named);
  }
  const auto problem = std::find_if(experiment.problems.begin(), experiment.problems.end(),
                                    [&](const Problem& p) { return p.name == problem_name; });
  if (strategy == experiment.strategies.end() || problem == experiment.problems.end()) {
    throw Error(fmt::format("replay: the script '{}' has no {} '{}' (any more)", found,
                            problem == experiment.problems.end() ? "problem" : "strategy",
                            problem == experiment.problems.end() ? problem_name : strategy_name));
  }
  for (const Json& known : document.at("experiment").at("strategies")) {
    if (known.at("name") != strategy_name) continue;
    const std::string hash = known.at("hash");
    if (hash != fmt::format("{:016x}", strategy->second.hash())) {
      throw Error(fmt::format("replay: '{}' is another strategy in '{}' now: {}, and was {}", strategy_name, found,
                              strategy->second.text(), known.at("text").get<std::string>()));
    }
  }
  const auto run = std::make_shared<Run>(
      Run{.strategy_name = strategy_name, .strategy = strategy->second, .problem = *problem, .seed = entry.seed});
  advance(*run, std::numeric_limits<std::uint64_t>::max(), interrupted);
  if (!run->ended()) return {"interrupted before there was anything to compare", run};
  const std::string difference = difference_text(entry, run->result());
  return {difference.empty() ? fmt::format("the same as run {} of {}", index, path)
                             : fmt::format("NOT the same as run {} of {}: {}", index, path, difference),
          run};
}

}  // namespace

Replayed replay_file(const std::string& path, std::int64_t index, const std::function<bool()>& interrupted) {
  constexpr std::size_t largest = std::size_t{1} << 30U;
  const std::string text = dsl::read_file(path, largest);
  const Json document = read_json(text, path);
  try {
    return replay_entry(document, read_results(text, path).runs, path, index, interrupted);
  } catch (const Json::exception& error) {
    throw Error(fmt::format("replay: '{}' is no document of 'trellis run --json': {}", path, error.what()));
  }
}

}  // namespace trellis::command
