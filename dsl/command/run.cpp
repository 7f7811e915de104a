// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include <dsl/command/choice.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/figure_options.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/learn.hpp>
#include <dsl/command/numbers.hpp>
#include <dsl/command/outputs.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/language/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/unused.hpp>
#include <trellis/figures/costs_figures.hpp>
#include <trellis/figures/figures.hpp>
#include <trellis/figures/html.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

constexpr std::uint64_t most_jobs = 1024;
constexpr int unbounded_width = 160;
constexpr int overview_width = 100;

ExperimentResult run_cells(const Experiment& experiment, unsigned jobs, bool quiet) {
  const InterruptibleRun interruptible;
  Progress progress(!quiet);
  progress.show(0, steps(experiment));
  return run(experiment, {.jobs = jobs,
                          .progress = [&](std::size_t done, std::size_t all) { progress.show(done, all); },
                          .interrupted = InterruptibleRun::requested});
}

/// Returns the experiment restricted to some of its problems.
Experiment part_of(const Experiment& experiment, std::size_t first, std::size_t count) {
  Experiment part = experiment;
  const auto begin = experiment.problems.begin() + static_cast<std::ptrdiff_t>(first);
  part.problems.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
  if (!part.published) return part;
  const auto elsewhere = [&](const std::string& name) {
    return std::none_of(part.problems.begin(), part.problems.end(), [&](const Problem& p) { return p.name == name; });
  };
  std::erase_if(part.published->entries, [&](const auto& entry) { return elsewhere(entry.problem); });
  std::erase_if(part.published->claims, [&](const auto& claim) { return elsewhere(claim.problem); });
  return part;
}

/// Applies --problem, --strategy and --only to an experiment.
void narrow(Experiment& experiment, const RunOptions& options, std::optional<std::uint64_t> only) {
  choose_problem(experiment, options.problem);
  choose_strategy(experiment, options.strategy);
  if (!options.strategy.empty()) {
    experiment.baseline.clear();
    experiment.ablations.clear();
  }
  // The published claims refer to the complete experiment.
  if (!options.problem.empty() || !options.strategy.empty()) experiment.published.reset();
  if (only) experiment.seeds = {*only};
}

void write_all_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& folder,
                       const SceneFigureOptions& options, bool quiet) {
  write_figures(experiment, result, folder, options.jobs, options.style);
  write_motion_figures(experiment, result, folder, options.jobs, options.style);
  for (const std::string& note : write_scene_figures(experiment, result, folder, options)) {
    if (!quiet) fmt::print(stderr, "trellis: {}\n", note);
  }
}

/// Writes the output of --out for the finished problems, except the figures of each strategy.
void write_out(const Experiment& experiment, const ExperimentResult& result, const RunOptions& options,
               const FigureStyle& style) {
  const std::filesystem::path folder(options.out);
  write_tables(options.style, options.out, report_markdown(experiment, result));
  write_file((folder / "table.csv").string(), report_csv(experiment, result));
  write_file((folder / "results.json").string(), report_json(experiment, result, options.script));
  write_html(experiment, result, (folder / "report.html").string(), {.script = options.script, .progress = {}});
  write_comparison_figures(experiment, result, (folder / "figures").string(), style);
}

/// Runs problem by problem, so that finished results remain if a later problem fails.
ExperimentResult run_problems(const Experiment& experiment, unsigned jobs, const RunOptions& options,
                              const SceneFigureOptions& drawing) {
  const InterruptibleRun interruptible;
  Progress progress(!options.quiet);
  const std::size_t all = steps(experiment);
  std::size_t before = 0;
  progress.show(0, all);
  ExperimentResult result;
  for (std::size_t i = 0; i < experiment.problems.size(); ++i) {
    const Experiment one = part_of(experiment, i, 1);
    try {
      ExperimentResult found =
          run(one, {.jobs = jobs,
                    .progress = [&](std::size_t done, std::size_t) { progress.show(before + done, all); },
                    .interrupted = InterruptibleRun::requested});
      progress.show("drawing " + one.problems.front().name);
      write_all_figures(one, found, (std::filesystem::path(options.out) / "figures").string(), drawing, options.quiet);
      std::move(found.runs.begin(), found.runs.end(), std::back_inserter(result.runs));
      result.planning_seconds += found.planning_seconds;
      result.measuring_seconds += found.measuring_seconds;
    } catch (const Interrupted&) {
      if (i == 0) throw;
      progress.show("writing what is finished");
      write_out(part_of(experiment, 0, i), result, options, drawing.style);
      std::vector<std::string> finished;
      for (std::size_t k = 0; k < i; ++k) finished.push_back(experiment.problems[k].name);
      throw Interrupted(fmt::format("interrupted; '{}' holds all of {}; the same command makes the rest too",
                                    options.out, fmt::join(finished, ", ")));
    }
    before += steps(one);
  }
  progress.show("writing the tables and the page");
  write_out(experiment, result, options, drawing.style);
  return result;
}

/// Reports on stderr each problem without any path, because all its values are missing.
void tell_unsolved(const Experiment& experiment, const ExperimentResult& result) {
  for (const Problem& problem : experiment.problems) {
    const bool solved = std::any_of(result.runs.begin(), result.runs.end(), [&](const RunResult& run) {
      return run.problem == problem.name && run.run.solved;
    });
    if (solved) continue;
    fmt::print(
        stderr,
        "trellis: {}: no run of any strategy found a path{}; give the planners more `proposals`, or examine where "
        "they got to\n",
        problem.name, experiment.measure ? ", so there is no target and no efficiency" : "");
  }
}

/// Warns on stderr about unused inputs.
void warn(const dsl::Program& program, const ExperimentResult& result) {
  for (const std::string& sentence : unused_guides(program.experiment, result)) {
    fmt::print(stderr, "trellis: warning: {}\n", sentence);
  }
  const auto& measure = program.experiment.measure;
  const char* why = !measure ? "the experiment measures nothing (measure = false)"
                    : !std::holds_alternative<UserTarget>(measure->target)
                        ? "the experiment is measured by another target (field 'measure')"
                        : "the experiment is measured by another target, or no run found a path";
  for (const auto& [function, guides] : program.uncalled()) {
    if (guides) {
      fmt::print(stderr, "trellis: warning: {} was never called in any run\n", function);
    } else {
      fmt::print(stderr, "trellis: warning: {} were never called: {}\n", function, why);
    }
  }
}

draw::RoleColours palette_option(const RunOptions& options) {
  if (options.palette.empty()) return draw::RoleColours::safe;
  static const std::vector<std::string> names = {"safe", "paper"};
  const auto found = std::find(names.begin(), names.end(), options.palette);
  if (found == names.end()) {
    throw Error(fmt::format("--palette: there are safe and paper, got '{}'{}", options.palette,
                            did_you_mean(options.palette, names)));
  }
  if (options.figures.empty() && options.out.empty()) throw Error("--palette: nothing is drawn without --figures");
  return found == names.begin() ? draw::RoleColours::safe : draw::RoleColours::paper;
}

ReportKind report_option(const RunOptions& options) {
  if (options.full && !options.report.empty() && options.report != "full") {
    throw Error(fmt::format("--full: it is --report full; leave out --report {}", options.report));
  }
  if (options.full) return ReportKind::full;
  if (options.report.empty()) return ReportKind::overview;
  const std::vector<std::string>& kinds = report_kinds();
  const auto found = std::find(kinds.begin(), kinds.end(), options.report);
  if (found == kinds.end()) {
    throw Error(fmt::format("--report: there are {}, got '{}'{}", fmt::join(kinds, ", "), options.report,
                            did_you_mean(options.report, kinds)));
  }
  return static_cast<ReportKind>(found - kinds.begin());
}

}  // namespace

int run(const RunOptions& options) {
  const auto seeds = integer_option("--seeds", options.seeds, 1, dsl::most_seeds);
  const auto seed = integer_option("--seed", options.seed, 0, dsl::largest_seed);
  const auto only = integer_option("--only", options.only, 0, dsl::largest_seed);
  if (only && (seeds || seed)) throw Error("--only: it is one seed; leave out --seed and --seeds");
  const auto jobs = integer_option("--jobs", options.jobs, 1, most_jobs);
  const auto cross = integer_option("--cross", options.cross, 0, dsl::most_seeds);

  const auto novelty = number_option("--novelty", options.novelty, 0.0);
  if (novelty && options.learn.empty()) throw Error("--novelty: nothing is learnt without --learn");

  const bool drawn = !options.figures.empty() || !options.out.empty();
  const SceneFigureOptions drawing{.colours = palette_option(options),
                                   .jobs = std::max(1U, std::thread::hardware_concurrency()),
                                   .style = figure_style(options.style, drawn)};
  check_format(options.style, !options.out.empty());
  const ReportKind kind = report_option(options);
  // Create the library before the script runs, so that a script may use a library without paths.
  if (!options.learn.empty()) static_cast<void>(Library(options.learn, Library::Mode::write));

  dsl::SessionOptions session = session_options(options.scripts);
  session.seed = seed.value_or(session.seed);
  dsl::Program program = dsl::load_script(options.script, session);
  dsl::override_seeds(program, seeds, seed);
  if (options.ablate) dsl::ablate_all(program.experiment, "--ablate");
  narrow(program.experiment, options, only);
  if (cross) {
    if (!program.experiment.measure) throw Error("--cross: the script measures nothing (measure = false)");
    program.experiment.measure->cross = static_cast<std::int64_t>(*cross);
  }

  // A run may take hours: check first that its results can be stored.
  if (!options.json.empty()) require_writable_file(options.json);
  if (!options.html.empty()) require_writable_file(options.html);
  OutputFolder samples(options.samples);
  OutputFolder figures(options.figures);
  OutputFolder out(options.out);

  const auto threads = static_cast<unsigned>(jobs.value_or(1));
  const ExperimentResult result = options.out.empty() ? run_cells(program.experiment, threads, options.quiet)
                                                      : run_problems(program.experiment, threads, options, drawing);
  out.keep();
  if (!options.out.empty()) tell_unsolved(program.experiment, result);

  // If one output fails, write the others anyway.
  std::optional<Error> failure;
  const auto attempt = [&](const std::function<void()>& write) {
    try {
      write();
    } catch (const Error& error) {
      if (!failure) failure = error;
    }
  };
  if (!options.quiet) {
    attempt([&] {
      print_all(report_text(program.experiment, result,
                            report_width(kind == ReportKind::overview ? overview_width : unbounded_width), kind));
    });
  }
  if (!options.json.empty()) {
    attempt([&] { write_file(options.json, report_json(program.experiment, result, options.script)); });
  }
  if (!options.html.empty()) {
    attempt([&] {
      Progress progress(!options.quiet);
      write_html(
          program.experiment, result, options.html,
          {.script = options.script, .progress = [&](std::size_t done, std::size_t all) { progress.show(done, all); }});
    });
  }
  if (!options.samples.empty()) {
    attempt([&] { write_samples(result, options.samples); });
    samples.keep();
  }
  if (!options.figures.empty()) {
    attempt([&] {
      write_all_figures(program.experiment, result, options.figures, drawing, options.quiet);
      write_comparison_figures(program.experiment, result, options.figures, drawing.style);
    });
    figures.keep();
  }
  if (!options.learn.empty())
    attempt([&] { learn(program.experiment, result, options.learn, novelty, options.quiet); });
  warn(program, result);
  if (failure) throw Error(*failure);
  return success;
}

}  // namespace trellis::command
