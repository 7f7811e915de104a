// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/cell.hpp>

#include <fmt/format.h>

#include <bit>
#include <utility>
#include <vector>

namespace trellis {

namespace {

/// Bitwise comparison, so that two NaNs are equal.
bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

bool same(const Configurations& a, const Configurations& b) {
  const auto& x = a.values();
  const auto& y = b.values();
  if (x.size() != y.size()) return false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!same(x[i], y[i])) return false;
  }
  return true;
}

template <class T>
std::string differ(const std::string& what, const T& x, const T& y) {
  return fmt::format("{}: {} before, {} now", what, x, y);
}

std::string difference_of(const Search& x, const Search& y, const std::string& level) {
  if (!same(x.proposals, y.proposals)) return fmt::format("the proposals of {} differ", level);
  if (!same(x.nodes, y.nodes) || x.parents != y.parents) return fmt::format("the nodes of {} differ", level);
  if (x.fates != y.fates || x.near != y.near || x.added != y.added) {
    return fmt::format("what became of the proposals of {} differs", level);
  }
  if (!same(x.controls.controls, y.controls.controls) || x.controls.steps != y.controls.steps ||
      x.controls.driven != y.controls.driven || x.controls.ends != y.controls.ends) {
    return fmt::format("the controls of {} differ", level);
  }
  if (x.proposal_sources != y.proposal_sources || x.sources != y.sources) {
    return fmt::format("the parts of h that drew the proposals of {} differ", level);
  }
  if (x.edges != y.edges) return fmt::format("the edges of {} differ", level);
  if (x.validated != y.validated) return fmt::format("the checked nodes of {} differ", level);
  if (x.checks.validity != y.checks.validity) {
    return differ("validity checks of " + level, x.checks.validity, y.checks.validity);
  }
  if (x.checks.motion != y.checks.motion) {
    return differ("motion checks of " + level, x.checks.motion, y.checks.motion);
  }
  return "";
}

std::string difference_of(const LevelRecord& x, const LevelRecord& y) {
  const std::string level = fmt::format("level {} ({})", x.level, x.name);
  if (x.key != y.key || x.name != y.name) return fmt::format("{} is level {} ({}) now", level, y.level, y.name);
  if (x.solves != y.solves) return differ("solves of " + level, x.solves, y.solves);
  std::string found = difference_of(x.search, y.search, level);
  if (!found.empty()) return found;
  if (x.solution.status != y.solution.status || !same(x.solution.path, y.solution.path)) {
    return fmt::format("the paths of {} differ", level);
  }
  if (!same(x.root_nodes(), y.root_nodes()) || !same(x.root_proposals(), y.root_proposals())) {
    return fmt::format("the samples of {}, lifted to the root, differ", level);
  }
  return same(x.proposal_atoms, y.proposal_atoms) ? "" : fmt::format("the densities of {} differ", level);
}

std::string difference_of(const RunRecord& x, const RunRecord& y) {
  if (x.status != y.status) return differ("status", to_string(x.status), to_string(y.status));
  if (x.validity_checks != y.validity_checks) return differ("validity checks", x.validity_checks, y.validity_checks);
  if (x.motion_checks != y.motion_checks) return differ("motion checks", x.motion_checks, y.motion_checks);
  if (x.shortcut_checks != y.shortcut_checks) {
    return differ("checks of shortcutting", x.shortcut_checks, y.shortcut_checks);
  }
  return same(x.path, y.path) && same(x.length, y.length) ? "" : "the paths differ";
}

bool same(const Turn& x, const Turn& y) {
  return x.level == y.level && x.proposals == y.proposals && x.nodes == y.nodes && x.solve_ended == y.solve_ended &&
         same(x.path, y.path);
}

}  // namespace

RunResult run_cell(const std::string& name, const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                   const ExecuteOptions& options) {
  RunResult run = make_cell(name, problem.name, seed, execute(strategy, problem, seed, options));
  run.reasons = unsolved_reasons(run, strategy);
  return run;
}

RunResult make_cell(const std::string& strategy, const std::string& problem, std::uint64_t seed, RunRecord run) {
  RunResult result;
  result.problem = problem;
  result.strategy = strategy;
  result.seed = seed;
  result.run = std::move(run);
  result.cpu_seconds = result.run.cpu_seconds;
  result.levels.reserve(result.run.levels.size());
  for (auto& record : result.run.levels) result.levels.emplace_back().record = std::move(record);
  result.run.levels.clear();
  return result;
}

void release(RunResult& run) {
  for (LevelResult& level : run.levels) level.record.release();
}

std::string difference_text(const RunResult& a, const RunResult& b) {
  std::string found = difference_of(a.run, b.run);
  if (!found.empty()) return found;
  if (a.levels.size() != b.levels.size()) return differ("levels", a.levels.size(), b.levels.size());
  for (std::size_t i = 0; i < a.levels.size(); ++i) {
    found = difference_of(a.levels[i].record, b.levels[i].record);
    if (!found.empty()) return found;
  }
  if (a.run.turns.size() != b.run.turns.size()) return "the turns of the levels differ";
  for (std::size_t i = 0; i < a.run.turns.size(); ++i) {
    if (!same(a.run.turns[i], b.run.turns[i])) return "the turns of the levels differ";
  }
  return "";
}

}  // namespace trellis
