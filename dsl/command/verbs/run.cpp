// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include <dsl/command/choice.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/figures.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/command/store/resume.hpp>
#include <dsl/command/verbs/learn.hpp>
#include <dsl/command/verbs/report.hpp>
#include <dsl/command/verbs/watch.hpp>
#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/input_warnings.hpp>
#include <trellis/experiment/partial.hpp>
#include <trellis/experiment/samples.hpp>
#include <trellis/experiment/unused.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/page/html.hpp>
#include <trellis/pictures/gltf.hpp>
#include <trellis/pictures/packed_run.hpp>
#include <trellis/pictures/scenery.hpp>
#include <trellis/pictures/stored_samples.hpp>
#include <trellis/pictures/trajectory.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/results/directories.hpp>
#include <trellis/results/records.hpp>

namespace trellis::command {

namespace {

constexpr std::uint64_t most_jobs = 1024;

struct RunOptions {
  std::string script;
  ScriptOptions scripts;
  std::optional<std::uint64_t> seeds;
  std::optional<std::uint64_t> seed;
  std::optional<std::uint64_t> only;  ///< one seed
  std::string problem;                ///< a name, "" for all
  std::string strategy;               ///< likewise
  std::optional<std::uint64_t> jobs;
  std::optional<std::uint64_t> threads;
  std::optional<std::uint64_t> cross;
  std::string json;                    ///< a file, "" if not given
  std::string csv;                     ///< a file, "" if not given
  std::string html;                    ///< a file, "" if not given
  std::string samples;                 ///< a folder, "" if not given
  std::string figures;                 ///< a folder, "" if not given
  std::string gltf;                    ///< a folder, "" if not given
  std::string trajectory;              ///< a file, "" if not given
  std::optional<double> velocity;      ///< TrajectorySettings
  std::optional<double> acceleration;  ///< likewise
  std::string out;                     ///< a folder for tables, the document and the page, "" if not given
  std::string learn;                   ///< a library of paths, "" if not given
  std::optional<double> novelty;       ///< metres
  std::optional<std::size_t> report;   ///< a ReportKind; none: the overview
  bool full = false;                   ///< the full report
  std::optional<std::uint64_t> width;  ///< of the report, in columns
  bool once = false;
  bool ablate = false;
  std::optional<double> ablation;  ///< Experiment::ablation
  bool watch = false;
  bool quiet = false;
  bool restart = false;
};

unsigned count_of(const std::optional<std::uint64_t>& option) { return static_cast<unsigned>(option.value_or(1)); }

/// Runs the experiment; after an interruption reduces it to what is finished (run_or_part).
ExperimentResult run_cells(Experiment& experiment, const RunOptions& options, ScoreScope scope, std::string& finished) {
  const InterruptibleRun interruptible;
  Progress progress(!options.quiet);
  const std::size_t cells = experiment.problems.size() * experiment.strategies.size() * experiment.seeds.size();
  progress.show("planning", 0, cells);
  return run_or_part(
      experiment,
      {.jobs = count_of(options.jobs),
       .threads = count_of(options.threads),
       .scope = scope,
       .progress = [&](std::size_t done, std::size_t all) { progress.show_experiment(done, all, cells); },
       .ablation_progress = [&](std::size_t done, std::size_t all) { progress.show("ablation", done, all); },
       .interrupted = InterruptibleRun::requested},
      finished);
}

/// Returns the experiment restricted to some of its problems.
Experiment part_of(const Experiment& experiment, std::size_t first, std::size_t count) {
  Experiment part = experiment;
  const auto begin = experiment.problems.begin() + static_cast<std::ptrdiff_t>(first);
  part.problems.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
  return part;
}

/// Applies --strategy and --ablate: the strategy of this name, and its ablations where these are requested.
void choose_strategies(Experiment& experiment, const RunOptions& options) {
  if (options.strategy.empty()) {
    if (options.ablate) dsl::ablate_all(experiment, "--ablate");
    return;
  }
  const bool own = std::any_of(experiment.strategies.begin(), experiment.strategies.end(),
                               [&](const auto& entry) { return entry.first == options.strategy; });
  // The name may be that of an ablation.
  if (options.ablate && !own) dsl::ablate_all(experiment, "--ablate");
  choose_strategy(experiment, options.strategy);
  experiment.baseline.clear();
  experiment.ablations.clear();
  if (options.ablate && own) dsl::ablate_all(experiment, "--ablate");
}

/// Applies --problem, --strategy, --ablate and --only to an experiment.
void narrow(Experiment& experiment, const RunOptions& options) {
  choose_problem(experiment, options.problem);
  choose_strategies(experiment, options);
  if (options.only) experiment.seeds = {*options.only};
}

/// Writes the output of --out for the finished problems.
void write_out(const Experiment& experiment, const ExperimentResult& result, ExperimentFacts facts,
               const ExperimentSummary& summary, const RunOptions& options) {
  const std::filesystem::path folder(options.out);
  facts.samples = "samples";
  write_packed_samples(experiment, result, (folder / facts.samples).string());
  write_file((folder / "runs.csv").string(), runs_csv(facts));
  if (const std::string couplings = couplings_csv(summary); !couplings.empty()) {
    write_file((folder / "couplings.csv").string(), couplings);
  }
  write_file((folder / "results.json").string(), report_json(facts, summary));
  StoredSamples samples((folder / facts.samples).string(), facts);
  write_html(facts, summary, &samples, (folder / "report.html").string());
}

/// Returns a folder as a document names it: relative to the folder of the document.
std::string from_document(const std::string& folder, const std::string& document) {
  namespace fs = std::filesystem;
  return fs::proximate(fs::absolute(folder), fs::absolute(document).parent_path()).generic_string();
}

/// The options that change the runs or their scores.
std::string options_text(const RunOptions& options) {
  std::string text = "run";
  for (const auto& [name, value] : {std::pair{"seeds", options.seeds}, std::pair{"seed", options.seed},
                                    std::pair{"only", options.only}, std::pair{"cross", options.cross}}) {
    if (value) text += fmt::format(" --{} {}", name, *value);
  }
  if (options.ablation) text += fmt::format(" --ablation {:g}", *options.ablation);
  if (!options.problem.empty()) text += fmt::format(" --problem '{}'", options.problem);
  if (!options.strategy.empty()) text += fmt::format(" --strategy '{}'", options.strategy);
  if (options.once) text += " --once";
  return options.ablate ? text + " --ablate" : text;
}

/// Writes what is finished after an interruption. Returns what remains.
Interrupted interrupted_after(std::size_t problems, const Experiment& experiment, const ExperimentResult& result,
                              const RunOptions& options, std::size_t runs) {
  std::vector<std::string> finished;
  if (problems > 0) {
    const Experiment part = part_of(experiment, 0, problems);
    ExperimentFacts facts = facts_of(part, result, options.script);
    facts.scenery = scenery_of(part);
    write_out(part, result, facts, summarise(facts), options);
  }
  for (std::size_t k = 0; k < problems; ++k) finished.push_back(experiment.problems[k].name);
  return Interrupted(fmt::format("interrupted; '{}' holds {} of {} runs{}{}; the same command continues", options.out,
                                 runs,
                                 experiment.problems.size() * experiment.strategies.size() * experiment.seeds.size(),
                                 finished.empty() ? "" : " and the results of ", fmt::join(finished, ", ")));
}

/// Runs problem by problem, so that finished results remain if a later problem fails.
ExperimentResult run_problems(const Experiment& experiment, const RunOptions& options, Resume& resume) {
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
          run(one,
              {.jobs = count_of(options.jobs),
               .threads = count_of(options.threads),
               .progress = [&](std::size_t done, std::size_t) { progress.show(before + done, all); },
               .interrupted = InterruptibleRun::requested},
              resume);
      std::move(found.runs.begin(), found.runs.end(), std::back_inserter(result.runs));
      std::move(found.pooled.begin(), found.pooled.end(), std::back_inserter(result.pooled));
      std::move(found.left_out.begin(), found.left_out.end(), std::back_inserter(result.left_out));
      std::move(found.uncoupled.begin(), found.uncoupled.end(), std::back_inserter(result.uncoupled));
      result.planning_seconds += found.planning_seconds;
      result.measuring_seconds += found.measuring_seconds;
    } catch (const Interrupted&) {
      progress.show("writing what is finished");
      throw interrupted_after(i, experiment, result, options, resume.runs());
    }
    before += steps(one);
  }
  return result;
}

/// Reports on stderr each problem without any path, because all its values are missing.
void tell_unsolved(const Experiment& experiment, const ExperimentResult& result) {
  for (const Problem& problem : experiment.problems) {
    const bool solved = std::any_of(result.runs.begin(), result.runs.end(), [&](const RunResult& run) {
      return run.problem == problem.name && run.run.solved;
    });
    if (solved) continue;
    print_message(fmt::format(
        "{}: no run of any strategy found a path{}; give the planners more `proposals`, or examine where they got to",
        problem.name, experiment.measure ? ", so there is no target and no efficiency" : ""));
  }
}

/// Warns on stderr about unused inputs.
/// \param scored  whether this process computed all scores
void warn(const dsl::Program& program, const ExperimentResult& result, bool scored) {
  for (const std::string& sentence : unused_guides(program.experiment, result)) {
    print_message(fmt::format("warning: {}", sentence));
  }
  const auto& measure = program.experiment.measure;
  const char* why = !measure ? "the experiment measures nothing (measure = false)"
                    : !std::holds_alternative<UserTarget>(measure->target)
                        ? "the experiment is measured by another target (field 'measure')"
                        : "the experiment is measured by another target, or no run found a path";
  for (const auto& [function, guides] : program.uncalled()) {
    if (!guides && !scored) continue;
    if (guides) {
      print_message(fmt::format("warning: {} was never called in any run", function));
    } else {
      print_message(fmt::format("warning: {} were never called: {}", function, why));
    }
  }
}

/// Prints on stderr the warnings of a report that is not printed.
void warn_of_guides(const ExperimentSummary& summary) {
  for (const ProblemSummary& problem : summary.problems) {
    for (const std::string& sentence : problem.warnings) {
      print_message(fmt::format("warning: {}: {}", problem.problem, sentence));
    }
  }
}

ReportKind report_kind(const RunOptions& options) {
  if (!options.full) return static_cast<ReportKind>(options.report.value_or(0));
  const auto full = static_cast<std::size_t>(ReportKind::full);
  if (options.report.value_or(full) != full) {
    throw Error(fmt::format("--full: it is --report full; leave out --report {}", report_kinds()[*options.report]));
  }
  return ReportKind::full;
}

/// \throws Error for options that contradict each other.
void check_combination(const RunOptions& options) {
  if (options.only && (options.seeds || options.seed)) {
    throw Error("--only: it is one seed; leave out --seed and --seeds");
  }
  if (options.restart && options.out.empty()) throw Error("--restart: nothing is stored without --out");
  if (options.watch && !options.out.empty()) {
    throw Error("--watch: the folder of --out belongs to one state of the script; use --json, --html or --figures");
  }
  if (options.novelty && options.learn.empty()) throw Error("--novelty: nothing is learnt without --learn");
  for (const auto& [name, value] :
       {std::pair{"--velocity", options.velocity}, std::pair{"--acceleration", options.acceleration}}) {
    if (!value) continue;
    if (options.trajectory.empty() && options.gltf.empty()) {
      throw Error(fmt::format("{}: nothing is timed without --trajectory or --gltf", name));
    }
    if (!(*value > 0.0)) throw Error(fmt::format("{}: it must be greater than 0", name));
  }
  if (!options.trajectory.empty()) {
    try {
      static_cast<void>(trajectory_form(options.trajectory));
    } catch (const Error& error) {
      throw Error(fmt::format("--trajectory: {}", error.what()));
    }
  }
}

TrajectorySettings trajectory_settings(const RunOptions& options) {
  TrajectorySettings settings;
  settings.velocity = options.velocity.value_or(settings.velocity);
  settings.acceleration = options.acceleration.value_or(settings.acceleration);
  return settings;
}

/// Writes the path of the first solved run with its times.
void write_trajectory(const Experiment& experiment, const ExperimentResult& result, const RunOptions& options) {
  const TimedRun timed = timed_run(experiment, result, trajectory_settings(options));
  write_file(options.trajectory, trajectory_text(timed, trajectory_form(options.trajectory)));
  if (options.quiet) return;
  print_message(fmt::format("{}: problem {}, strategy {}, seed {}, {:.3g} s", options.trajectory, timed.run->problem,
                            timed.run->strategy, timed.run->seed, timed.path.duration()));
}

/// Whether there is an output beside that of --out.
bool has_other_outputs(const RunOptions& options) {
  const std::array outputs = {&options.json,    &options.csv,  &options.html,  &options.samples,
                              &options.figures, &options.gltf, &options.learn, &options.trajectory};
  return std::any_of(outputs.begin(), outputs.end(), [](const std::string* output) { return !output->empty(); });
}

/// Returns the scores that the outputs have: without files, the overview prints a part of them.
ScoreScope scope_of(const RunOptions& options, ReportKind kind) {
  const std::array files = {&options.json,    &options.csv,     &options.html,
                            &options.samples, &options.figures, &options.out};
  const bool none = std::all_of(files.begin(), files.end(), [](const std::string* file) { return file->empty(); });
  const bool overview = options.quiet || kind == ReportKind::overview || kind == ReportKind::levels;
  return none && overview ? ScoreScope::overview : ScoreScope::all;
}

/// Loads the script and applies the options to its experiment.
dsl::Program program_of(const RunOptions& options, dsl::SessionOptions session) {
  session.seed = options.seed.value_or(session.seed);
  dsl::Program program = dsl::load_script(options.script, session);
  dsl::override_seeds(program, options.seeds, options.seed);
  if (options.once) {
    for (auto& [name, strategy] : program.experiment.strategies) strategy = strategy.with("queries", 1.0);
  }
  narrow(program.experiment, options);
  if (options.ablation) program.experiment.ablation = *options.ablation;
  if (options.cross) {
    if (!program.experiment.measure) throw Error("--cross: the script measures nothing (measure = false)");
    program.experiment.measure->cross = static_cast<std::int64_t>(*options.cross);
  }
  return program;
}

/// Runs writers of outputs. If one fails, the others write anyway, and `finish` throws its error.
class Writers {
 public:
  void attempt(bool wanted, const std::function<void()>& write) {
    if (!wanted) return;
    try {
      write();
    } catch (const Error& error) {
      if (!failure_) failure_ = error;
    }
  }
  void finish() const {
    if (failure_) throw Error(*failure_);
  }

 private:
  std::optional<Error> failure_;
};

void write_page(const Experiment& experiment, const ExperimentResult& result, const ExperimentFacts& facts,
                const ExperimentSummary& summary, const RunOptions& options) {
  Progress progress(!options.quiet);
  const auto show = [&](std::size_t done, std::size_t all) { progress.show(done, all); };
  PackedRuns samples(experiment, result);
  write_html(facts, summary, &samples, options.html, {.progress = show});
}

int run(const RunOptions& options) {
  check_combination(options);
  const ReportKind kind = report_kind(options);
  // Create the library before the script runs, so that a script may use a library without paths.
  if (!options.learn.empty()) static_cast<void>(Library(options.learn, Library::Mode::write));
  dsl::SessionOptions session = session_options(options.scripts);
  const ScriptFiles files(session);
  dsl::Program program = program_of(options, session);
  Experiment& experiment = program.experiment;

  // A run may take hours: check first that its results can be stored.
  if (!options.json.empty()) require_writable_file(options.json);
  if (!options.csv.empty()) require_writable_file(options.csv);
  if (!options.html.empty()) require_writable_file(options.html);
  if (!options.trajectory.empty()) require_writable_file(options.trajectory);
  OutputFolder samples(options.samples);
  OutputFolder figures(options.figures);
  OutputFolder gltf(options.gltf);
  OutputFolder out(options.out);
  std::optional<Resume> resume;
  if (!options.out.empty()) {
    check(experiment);
    const Manifest manifest = files.manifest(options.script, options_text(options), {}, experiment);
    if (!options.restart) require_same(options.out, manifest);
    resume.emplace(options.out, manifest, options.restart, has_other_outputs(options));
    if (resume->runs() > 0 && !options.quiet) {
      print_message(fmt::format("continues '{}', which holds {} of {} runs; --restart starts again", options.out,
                                resume->runs(), RunList(manifest.experiment).size()));
    }
    out.keep();
  }

  for (const std::string& sentence : program.warnings) print_message(fmt::format("warning: {}", sentence));
  for (const std::string& sentence : input_warnings(experiment)) {
    print_message(fmt::format("warning: {}", sentence));
  }
  std::string finished;  // before an interruption
  const ExperimentResult result = resume ? run_problems(experiment, options, *resume)
                                         : run_cells(experiment, options, scope_of(options, kind), finished);
  samples.keep();
  figures.keep();
  gltf.keep();
  if (resume) tell_unsolved(experiment, result);

  ExperimentFacts facts = facts_of(experiment, result, options.script);
  facts.scenery = scenery_of(experiment);
  const ExperimentSummary summary = summarise(facts);
  if (resume) {
    Progress progress(!options.quiet);
    progress.show("writing the tables and the page");
    resume->attempt([&] {
      write_out(experiment, result, facts, summary, options);
      resume->finish(facts);
    });
  }
  Writers writers;
  writers.attempt(resume && resume->failure(), [&] { throw Error(*resume->failure()); });
  writers.attempt(!options.quiet, [&] { print_report(summary, kind, options.width); });
  if (options.quiet) warn_of_guides(summary);
  writers.attempt(!options.json.empty(), [&] {
    if (!options.samples.empty()) facts.samples = from_document(options.samples, options.json);
    write_file(options.json, report_json(facts, summary));
  });
  writers.attempt(!options.csv.empty(), [&] { write_file(options.csv, runs_csv(facts)); });
  writers.attempt(!options.html.empty(), [&] { write_page(experiment, result, facts, summary, options); });
  writers.attempt(!options.samples.empty(), [&] {
    write_samples(result, options.samples);
    write_packed_samples(experiment, result, options.samples);
  });
  writers.attempt(!options.figures.empty(), [&] {
    Progress progress(!options.quiet);
    progress.show("drawing");
    draw_figures(experiment, result, options.figures);
  });
  writers.attempt(!options.gltf.empty(), [&] {
    for (const std::string& note : write_gltf(experiment, result, options.gltf, trajectory_settings(options))) {
      if (!options.quiet) print_message(note);
    }
  });
  writers.attempt(!options.trajectory.empty(), [&] { write_trajectory(experiment, result, options); });
  writers.attempt(!options.learn.empty(),
                  [&] { learn(experiment, result, options.learn, options.novelty, options.quiet); });
  warn(program, result, !resume || !resume->restored());
  writers.finish();
  if (!finished.empty()) {
    throw Interrupted(
        fmt::format("interrupted; what is finished, and is kept: {}; the same command makes the rest too", finished));
  }
  return success;
}

/// Runs the script, and again each time that its files change, until a signal ends it.
int run_and_watch(const RunOptions& options) {
  while (true) {
    const WatchedFiles files(options.script);  // as they are before the run
    try {
      static_cast<void>(run(options));
    } catch (const Error& error) {
      print_error(error);
    }
    finish_output();
    print_message(fmt::format("watching {}; Ctrl-C ends", fmt::join(files.names(), ", ")));
    const std::string changed = files.wait();
    print_message(fmt::format("{} has changed", changed));
  }
}

}  // namespace

void add_run(CommandLine& line) {
  const auto options = std::make_shared<RunOptions>();
  Subcommand verb = line.add("run", "run a script's experiment and print the report",
                             [options] { return options->watch ? run_and_watch(*options) : run(*options); });
  verb.argument("SCRIPT", "FILE", options->script, "a Lua script");
  verb.integer("--seeds", "N", 1, dsl::most_seeds, options->seeds,
               "the number of consecutive seeds, instead of the script's");
  verb.integer("--seed", "SEED", 0, dsl::largest_seed, options->seed, "the first seed, instead of the script's");
  verb.integer("--only", "SEED", 0, dsl::largest_seed, options->only,
               "this seed alone, in the world that the script makes for its own seeds");
  verb.text("--problem", "NAME", options->problem, "the problem of this name alone");
  verb.text("--strategy", "NAME", options->strategy, "the strategy of this name alone");
  verb.integer("--jobs", "N", 1, most_jobs, options->jobs,
               "runs at the same time (default 1, so that their times compare); scoring takes all cores");
  verb.integer(
      "--threads", "N", 1, most_jobs, options->threads,
      "threads of each run: they compute ahead for searches without a guide; the results are the same, in less "
      "time for more CPU time (default 1)");
  verb.flag("--once", options->once,
            "each run is the only one in its world: it sets up its guides anew, and counts all of that (queries = 1)");
  verb.integer("--cross", "N", 0, dsl::most_seeds, options->cross,
               "paths of other seeds to score each run on, instead of the script's");
  verb.flag("--ablate", options->ablate,
            "run every strategy with each of its guides taken out, too, and list and score these strategies");
  verb.number("--ablation", "TIMES", 0.0, options->ablation,
              "the work for the verdicts on levels, as a multiple of the experiment's (default 2); 0: none");
  verb.text("--json", "FILE", options->json, "write all figures to a file");
  verb.text("--csv", "FILE", options->csv, "write a table of the runs to a file, a row for each");
  verb.text("--html", "FILE", options->html, "write a page that shows the results and replays the runs");
  verb.text("--samples", "FOLDER", options->samples, "write all samples and paths into a folder");
  verb.text("--figures", "FOLDER", options->figures,
            "draw figures and tables for papers into a folder (needs matplotlib of Python)");
  verb.text("--gltf", "FOLDER", options->gltf,
            "write the motions in space as glTF 2.0 into a folder, a file for each strategy");
  verb.text("--trajectory", "FILE", options->trajectory,
            "write the path of the first solved run with times, which keep the joints' limits and stop where it bends: "
            "a JointTrajectory of ROS (.yaml), or a table (.csv)");
  verb.number("--velocity", "SPEED", 0.0, options->velocity,
              "of joints whose URDF file states none, in rad/s or m/s (default 1), for --trajectory and --gltf");
  verb.number("--acceleration", "RATE", 0.0, options->acceleration,
              "of all joints, in rad/s^2 or m/s^2 (default 1), for --trajectory and --gltf");
  verb.text("--out", "FOLDER", options->out,
            "write tables, the document and the page into a folder, problem by problem; continues when repeated");
  verb.flag("--restart", options->restart, "delete the records in the folder of --out and start again");
  verb.text("--learn", "FILE", options->learn, "add the paths that were found and are new to a library of paths");
  verb.number("--novelty", "METRES", 0.0, options->novelty,
              "how far from all that the library has a path is new, in metres (default the robot's bounding radius)");
  verb.choice("--report", report_kinds(), options->report,
              "what is printed: overview (default), levels, efficiency or full");
  verb.flag("--full", options->full, "as --report full");
  verb.integer(
      "--width", "N", 60, 1000, options->width,
      "the report's width in columns (default the terminal's, else COLUMNS of the environment, else 100 or 160)");
  verb.flag("--watch", options->watch, "run again each time that the script or a module that it requires changes");
  verb.flag("--quiet", options->quiet, "print neither report nor progress");
  add_script_options(verb, options->scripts);
}

}  // namespace trellis::command
