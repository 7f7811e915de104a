// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <dsl/command/commands.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/command/store/records.hpp>
#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/base/parallel.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/results/records.hpp>

namespace trellis::command {

namespace {

constexpr std::uint64_t most_jobs = 1024;

struct SweepOptions {
  std::string script;
  ScriptOptions scripts;
  std::optional<std::uint64_t> seeds;
  std::optional<std::uint64_t> seed;
  std::optional<std::uint64_t> jobs;
  std::string out;
  std::string shard;  ///< "I/N", "" for all
  bool ablate = false;
  bool restart = false;
  bool quiet = false;
};

dsl::Program program_of(const SweepOptions& options, dsl::SessionOptions session) {
  session.seed = options.seed.value_or(session.seed);
  dsl::Program program = dsl::load_script(options.script, session);
  dsl::override_seeds(program, options.seeds, options.seed);
  if (options.ablate) dsl::ablate_all(program.experiment, "--ablate");
  program.experiment.ablation = 0.0;  // a sweep runs what it lists, and nothing after that
  return program;
}

std::string options_text(const SweepOptions& options) {
  std::string text = "sweep";
  if (options.seeds) text += fmt::format(" --seeds {}", *options.seeds);
  if (options.seed) text += fmt::format(" --seed {}", *options.seed);
  return options.ablate ? text + " --ablate" : text;
}

/// Runs the missing cells.
void run_missing(const Experiment& experiment, const std::vector<std::size_t>& missing, const RunList& runs,
                 RecordFile& file, const SweepOptions& options, std::size_t all) {
  const InterruptibleRun interruptible;
  Progress progress(!options.quiet);
  std::mutex mutex;  // guards the progress bar and its count
  std::size_t done = all - missing.size();
  std::atomic<bool> stop{false};
  progress.show(done, all);
  const auto interrupted = [&] { return stop.load() || InterruptibleRun::requested(); };
  const std::size_t seeds = experiment.seeds.size();
  const std::size_t strategies = experiment.strategies.size();
  in_parallel(missing.size(), static_cast<unsigned>(options.jobs.value_or(1)), [&](std::size_t turn) {
    const std::size_t cell = missing[turn];
    try {
      if (interrupted()) throw Interrupted();
      const auto& [name, spec] = experiment.strategies[cell / seeds % strategies];
      RunResult run =
          run_cell(name, spec, experiment.problems[cell / seeds / strategies], experiment.seeds[cell % seeds],
                   {.shortcut = experiment.shortcut, .interrupted = interrupted, .measured = false});
      if (run.run.status == Status::interrupted) throw Interrupted();
      if (cell % seeds == 0) {
        check_unused_guides(spec, experiment.problems[cell / seeds / strategies], run.run);
      }
      for (LevelResult& level : run.levels) {
        level.rejections = rejections(level.record, experiment.problems[cell / seeds / strategies].resolution);
      }
      release(run);
      file.append(runs.key(cell), run_line(facts_of(run)));
      const std::scoped_lock lock(mutex);
      progress.show(++done, all);
    } catch (...) {
      stop.store(true);
      throw;
    }
  });
}

int sweep(const SweepOptions& options) {
  if (options.out.empty()) throw Error("--out: name the folder of the records");
  dsl::SessionOptions session = session_options(options.scripts);
  const ScriptFiles files(session);
  const dsl::Program program = program_of(options, session);
  const Experiment& experiment = program.experiment;
  check(experiment);
  OutputFolder out(options.out);
  const Manifest manifest =
      files.manifest(options.script, options_text(options), Shard::parse(options.shard), experiment);
  if (!options.restart) require_same(options.out, manifest);
  RecordFile file(options.out, "runs.jsonl", options.restart);
  if (options.restart || !Manifest::exists(options.out)) manifest.write(options.out);
  out.keep();
  const RunList runs(manifest.experiment);
  const std::vector<std::size_t> cells = cells_of(manifest.experiment, manifest.shard);
  std::vector<std::size_t> missing;
  for (const std::size_t cell : cells) {
    if (!file.contains(runs.key(cell))) missing.push_back(cell);
  }
  try {
    run_missing(experiment, missing, runs, file, options, cells.size());
  } catch (const Interrupted&) {
    throw Interrupted(fmt::format("interrupted; '{}' holds {} of {} runs; the same command continues", options.out,
                                  file.size(), cells.size()));
  }
  write_results(options.out, manifest, [&](std::size_t run) {
    auto line = file.find(runs.key(run));
    if (!line) throw Error(fmt::format("'{}' lacks the record of {}", options.out, runs.key(run).text()));
    return std::move(*line);
  });
  if (!options.quiet) {
    print_all(fmt::format("{} runs in '{}', {} of them new\n", cells.size(), options.out, missing.size()));
  }
  return success;
}

}  // namespace

void add_sweep(CommandLine& line) {
  const auto options = std::make_shared<SweepOptions>();
  Subcommand verb =
      line.add("sweep", "plan a script's runs without scoring, stored one by one; continues when repeated",
               [options] { return sweep(*options); });
  verb.argument("SCRIPT", "FILE", options->script, "a Lua script");
  verb.text("--out", "FOLDER", options->out, "the folder of the records", true);
  verb.text("--shard", "I/N", options->shard, "the part I of N parts of the runs alone; trellis merge joins them");
  verb.integer("--seeds", "N", 1, dsl::most_seeds, options->seeds,
               "the number of consecutive seeds, instead of the script's");
  verb.integer("--seed", "SEED", 0, dsl::largest_seed, options->seed, "the first seed, instead of the script's");
  verb.integer("--jobs", "N", 1, most_jobs, options->jobs,
               "runs at the same time (default 1, so that their times compare)");
  verb.flag("--ablate", options->ablate, "run every strategy with each of its guides taken out, too");
  verb.flag("--restart", options->restart, "delete the records of the folder and start again");
  verb.flag("--quiet", options->quiet, "print neither result nor progress");
  add_script_options(verb, options->scripts);
}

}  // namespace trellis::command
