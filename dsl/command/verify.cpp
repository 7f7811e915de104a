// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dsl/command/commands.hpp>
#include <dsl/command/outputs.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/language/session.hpp>
#include <dsl/language/stdlib.hpp>
#include <trellis/base/error.hpp>
#include <trellis/instance/path_fault.hpp>
#include <trellis/report/stored_paths.hpp>

namespace trellis::command {

namespace {

struct Options {
  std::vector<std::string> files;     ///< documents of trellis run --json
  std::string script;                 ///< replaces the script that the documents name, "" if not given
  std::optional<std::uint64_t> seed;  ///< of math.random while the script loads
  ScriptOptions scripts;
};

/// Returns the problem with finer motion checks by the other collision backend.
Problem stricter(const Problem& problem) {
  Problem result = with_finer_motions(problem);
  result.collision = problem.collision == "planar" ? "fcl" : "planar";
  return result;
}

const Problem& problem_of(const std::vector<Problem>& problems, const std::string& name, const std::string& script) {
  const auto found = std::find_if(problems.begin(), problems.end(), [&](const Problem& p) { return p.name == name; });
  if (found != problems.end()) return *found;
  std::vector<std::string> known;
  known.reserve(problems.size());
  for (const Problem& problem : problems) known.push_back(problem.name);
  throw Error(fmt::format("{}: no problem is called '{}'{}; --script names the script of the results", script, name,
                          did_you_mean(name, known)));
}

int verify(const Options& options) {
  constexpr std::size_t largest = std::size_t{4} << 30U;
  dsl::SessionOptions session = session_options(options.scripts);
  session.seed = options.seed.value_or(session.seed);
  std::size_t verified = 0;
  std::size_t faults = 0;
  std::size_t unsolved = 0;
  std::string text;
  for (const std::string& file : options.files) {
    const StoredPaths stored = read_stored_paths(dsl::read_file(file, largest), file);
    const std::string script = options.script.empty() ? stored.script : options.script;
    const std::vector<Problem> problems = dsl::load_script(script, session).experiment.problems;
    unsolved += stored.unsolved;
    std::map<std::string, Problem> checked;
    for (const StoredRunPath& run : stored.paths) {
      auto problem = checked.find(run.problem);
      if (problem == checked.end()) {
        problem = checked.emplace(run.problem, stricter(problem_of(problems, run.problem, script))).first;
      }
      ++verified;
      std::string fault = path_fault(problem->second, run.path);
      if (fault.empty() && problem->second.motion_model) {
        fault =
            run.trajectory.dt > 0.0 ? trajectory_fault(problem->second, run.path, run.trajectory) : "has no trajectory";
      }
      if (fault.empty()) continue;
      ++faults;
      text += fmt::format("{}: {}, seed {}: the path {}\n", run.problem, run.strategy, run.seed, fault);
    }
  }
  text += fmt::format("{} of {} paths valid at {:g} times the resolution, by the other collision backend{}\n",
                      verified - faults, verified, path_check_refinement,
                      unsolved > 0 ? fmt::format("; {} runs found no path", unsolved) : "");
  print_all(text);
  return faults == 0 ? success : tests_failed;
}

}  // namespace

void add_verify(CommandLine& line) {
  const auto options = std::make_shared<Options>();
  Subcommand verb = line.add("verify", "validate the paths in results of trellis run again, more finely",
                             [options] { return verify(*options); });
  verb.arguments("RESULTS", "FILE", options->files, "documents that trellis run --json wrote");
  verb.text("--script", "FILE", options->script, "the script of the results, instead of the one that they name");
  verb.integer("--seed", "SEED", 0, dsl::largest_seed, options->seed,
               "the --seed that trellis run had, where the script makes random worlds");
  add_script_options(verb, options->scripts);
}

}  // namespace trellis::command
