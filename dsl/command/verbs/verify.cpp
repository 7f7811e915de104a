// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dsl/command/commands.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/path_fault.hpp>

namespace trellis::command {

namespace {

struct VerifyOptions {
  std::vector<std::string> files;     ///< documents of trellis run --json
  std::string script;                 ///< replaces the script that the documents name, "" if not given
  std::optional<std::uint64_t> seed;  ///< of math.random while the script loads
  ScriptOptions scripts;
};

/// As many times the problem's resolution has the second opinion.
constexpr double refinement = 4.0;

/// Returns the problem with finer motion checks by another collision backend.
Problem second_opinion(const Problem& problem) {
  Problem result = problem;
  result.resolution /= refinement;
  const std::vector<std::string> backends = collision_backends(*problem.scene);
  result.collision = problem.collision == backends.front() ? backends.back() : backends.front();
  return result;
}

/// Returns why a run's path does not solve its problem; "" if it does.
std::string fault_of(const RunFacts& run, const Problem& problem, double& clearance) {
  std::string fault = path_fault(problem, run.path, &clearance);
  if (fault.empty()) fault = checked_fault(second_opinion(problem), run.path);
  if (!fault.empty() || !problem.motion_model) return fault;
  return run.trajectory.dt > 0.0 ? trajectory_fault(problem, run.path, run.trajectory) : "has no trajectory";
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

int verify(const VerifyOptions& options) {
  dsl::SessionOptions session = session_options(options.scripts);
  session.seed = options.seed.value_or(session.seed);
  std::size_t verified = 0;
  std::size_t faults = 0;
  std::size_t unsolved = 0;
  double least = std::numeric_limits<double>::infinity();
  std::string text;
  for (const std::string& file : options.files) {
    const ExperimentFacts stored = read_document(file);
    const std::string script = options.script.empty() ? stored.script : options.script;
    const std::vector<Problem> problems = dsl::load_script(script, session).experiment.problems;
    for (const RunFacts& run : stored.runs) {
      if (!run.solved) {
        ++unsolved;
        continue;
      }
      double clearance = 0.0;
      ++verified;
      const std::string fault = fault_of(run, problem_of(problems, run.problem, script), clearance);
      if (fault.empty()) {
        least = std::min(least, clearance);
        continue;
      }
      ++faults;
      text += fmt::format("{}: {}, seed {}: the path {}\n", run.problem, run.strategy, run.seed, fault);
    }
  }
  text +=
      fmt::format("{} of {} paths certified{}{}\n", verified - faults, verified,
                  verified > faults && std::isfinite(least) ? fmt::format(", smallest clearance {:.3g} m", least) : "",
                  unsolved > 0 ? fmt::format("; {} runs found no path", unsolved) : "");
  print_all(text);
  return faults == 0 ? success : tests_failed;
}

}  // namespace

void add_verify(CommandLine& line) {
  const auto options = std::make_shared<VerifyOptions>();
  Subcommand verb = line.add("verify", "certify the paths in results of trellis run again", [options] {
    name_documents(options->files);
    return verify(*options);
  });
  verb.arguments("RESULTS", "FILE", options->files, "documents that trellis run --json wrote, or folders of --out");
  verb.text("--script", "FILE", options->script, "the script of the results, instead of the one that they name");
  verb.integer("--seed", "SEED", 0, dsl::largest_seed, options->seed,
               "the --seed that trellis run had, where the script makes random worlds");
  add_script_options(verb, options->scripts);
}

}  // namespace trellis::command
