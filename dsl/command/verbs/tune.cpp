// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <dsl/command/commands.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/script_options.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/command/tuning.hpp>
#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>

namespace trellis::command {

namespace {

constexpr std::uint64_t most_jobs = 1024;

struct TuneOptions {
  std::string script;
  ScriptOptions scripts;
  std::optional<std::uint64_t> budget;
  std::optional<std::uint64_t> seed;
  std::optional<std::uint64_t> jobs;
  std::optional<std::uint64_t> width;
  bool quiet = false;
};

int tune(const TuneOptions& options) {
  constexpr int unbounded_width = 120;
  dsl::SessionOptions session = session_options(options.scripts);
  session.seed = options.seed.value_or(session.seed);
  const dsl::Program program = dsl::load_script(options.script, session);
  if (!program.tuning) {
    throw Error(options.script +
                ": the script returns no tuning; end it with 'return tune(strategy, problems, { over = "
                "{ ... } })'");
  }
  TuneSettings settings = *program.tuning;
  settings.budget = options.budget.value_or(settings.budget);
  settings.seed = options.seed.value_or(settings.seed);
  const auto width =
      static_cast<std::size_t>(options.width.value_or(static_cast<std::uint64_t>(report_width(unbounded_width))));
  const InterruptibleRun interruptible;
  std::optional<Progress> progress(!options.quiet);
  const TuneResult result =
      tune(program.experiment, settings,
           {.jobs = static_cast<unsigned>(options.jobs.value_or(1)),
            .progress = [&](std::size_t done, std::size_t all) { progress->show("planning", done, all); },
            .interrupted = InterruptibleRun::requested});
  progress.reset();
  print_all(tuning_text(program.experiment, settings, result, width));
  return success;
}

}  // namespace

void add_tune(CommandLine& line) {
  const auto options = std::make_shared<TuneOptions>();
  Subcommand verb = line.add("tune", "select the best values of a strategy by successive halving over seeds",
                             [options] { return tune(*options); });
  verb.argument("SCRIPT", "FILE", options->script, "a Lua script that returns tune(...)");
  verb.integer("--budget", "N", 1, 1'000'000'000, options->budget,
               "the largest number of runs, instead of the script's");
  verb.integer("--seed", "SEED", 0, dsl::largest_seed, options->seed, "the first seed, instead of the script's");
  verb.integer("--jobs", "N", 1, most_jobs, options->jobs,
               "runs at the same time (default 1, so that their times compare)");
  verb.integer("--width", "N", 60, 1000, options->width,
               "the table's width in columns (default the terminal's, else COLUMNS of the environment, else 120)");
  verb.flag("--quiet", options->quiet, "print no progress");
  add_script_options(verb, options->scripts);
}

}  // namespace trellis::command
