// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <dsl/command/commands.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/numbers.hpp>
#include <dsl/command/outputs.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/language/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

constexpr std::uint64_t most_jobs = 1024;
constexpr int unbounded_width = 160;

ExperimentResult run_cells(const Experiment& experiment, unsigned jobs, bool quiet) {
  const InterruptibleRun interruptible;
  Progress progress(!quiet);
  progress.show(0, steps(experiment));
  return run(experiment, {.jobs = jobs,
                          .progress = [&](std::size_t done, std::size_t all) { progress.show(done, all); },
                          .interrupted = InterruptibleRun::requested});
}

draw::RoleColours palette_option(const RunOptions& options) {
  if (options.palette.empty()) return draw::RoleColours::safe;
  static const std::vector<std::string> names = {"safe", "paper"};
  const auto found = std::find(names.begin(), names.end(), options.palette);
  if (found == names.end()) {
    throw Error(fmt::format("--palette: there are safe and paper, got '{}'{}", options.palette,
                            did_you_mean(options.palette, names)));
  }
  if (options.figures.empty()) throw Error("--palette: nothing is drawn without --figures");
  return found == names.begin() ? draw::RoleColours::safe : draw::RoleColours::paper;
}

}  // namespace

int run(const RunOptions& options) {
  constexpr auto largest_seed = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  const auto seeds = integer_option("--seeds", options.seeds, 1, dsl::most_seeds);
  const auto seed = integer_option("--seed", options.seed, 0, largest_seed);
  const auto jobs = integer_option("--jobs", options.jobs, 1, most_jobs);
  const auto cross = integer_option("--cross", options.cross, 0, dsl::most_seeds);

  const draw::RoleColours colours = palette_option(options);

  dsl::SessionOptions session;
  session.seed = seed.value_or(session.seed);
  dsl::Program program = dsl::load_script(options.script, session);
  dsl::override_seeds(program, seeds, seed);
  if (options.ablate) dsl::ablate_all(program.experiment, "--ablate");
  if (cross) {
    if (!program.experiment.measure) throw Error("--cross: the script measures nothing (measure = false)");
    program.experiment.measure->cross = static_cast<std::int64_t>(*cross);
  }

  // A run may take hours: what would make its results impossible to keep is found out first.
  if (!options.json.empty()) require_writable_file(options.json);
  OutputFolder samples(options.samples);
  OutputFolder figures(options.figures);

  const ExperimentResult result = run_cells(program.experiment, static_cast<unsigned>(jobs.value_or(1)), options.quiet);

  // One output that fails does not take the others with it.
  std::optional<Error> failure;
  const auto attempt = [&](const std::function<void()>& write) {
    try {
      write();
    } catch (const Error& error) {
      if (!failure) failure = error;
    }
  };
  if (!options.quiet) {
    attempt([&] { print_all(report_text(program.experiment, result, report_width(unbounded_width))); });
  }
  if (!options.json.empty()) {
    attempt([&] { write_file(options.json, report_json(program.experiment, result, options.script)); });
  }
  if (!options.samples.empty()) {
    attempt([&] { write_samples(result, options.samples); });
    samples.keep();
  }
  if (!options.figures.empty()) {
    attempt([&] { write_figures(program.experiment, result, options.figures); });
    attempt([&] {
      for (const std::string& note :
           write_scene_figures(program.experiment, result, options.figures, {.colours = colours})) {
        if (!options.quiet) fmt::print(stderr, "trellis: {}\n", note);
      }
    });
    figures.keep();
  }
  if (failure) throw Error(*failure);
  return success;
}

}  // namespace trellis::command
