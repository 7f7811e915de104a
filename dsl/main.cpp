// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <dsl/command/commands.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/manual.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>

namespace {

using namespace trellis;  // NOLINT(google-build-using-namespace): the program's own

int dispatch(int argc, char** argv) {
  CLI::App app("Trellis runs scripts that declare hierarchies of guiding spaces for motion planning.", "trellis");
  app.require_subcommand(1);

  const auto add_script_options = [](CLI::App* verb, command::ScriptOptions& scripts) {
    verb->add_option("--memory", scripts.memory, "the memory that a script may hold, in MiB (default 1024)");
    verb->add_option("--instructions", scripts.instructions,
                     "what a script may work while it loads, in instructions (default 1000000000); each call of one of "
                     "its functions later on a tenth");
    verb->add_flag("--trust", scripts.trust, "let scripts reach all files and processes: io, os, debug");
  };

  const auto add_figure_options = [](CLI::App* verb, command::FigureOptions& style) {
    verb->add_option("--column", style.column,
                     "the figures' width, in millimetres, as of a paper's column; below 127 panels stand below each "
                     "other");
    verb->add_flag("--untitled", style.untitled,
                   "figures without title and caption, which a text file beside each figure has");
    verb->add_flag("--serif", style.serif, "figures in a typeface with serifs");
    verb->add_flag("--scalebar", style.scale_bar, "a scale bar in pictures of the world");
    verb->add_option("--format", style.format, "of the tables that --out writes: markdown (default) or latex");
  };

  command::RunOptions options;
  auto* run = app.add_subcommand("run", "run a script's experiment and print the report");
  run->add_option("SCRIPT", options.script, "a Lua script")->required();
  run->add_option("--seeds", options.seeds, "the number of consecutive seeds, instead of the script's");
  run->add_option("--seed", options.seed, "the first seed, instead of the script's");
  run->add_option("--only", options.only, "this seed alone, in the world that the script makes for its own seeds");
  run->add_option("--problem", options.problem, "the problem of this name alone");
  run->add_option("--strategy", options.strategy, "the strategy of this name alone");
  run->add_option("--jobs", options.jobs,
                  "runs at the same time (default 1, so that their times compare); scoring takes all cores");
  run->add_option("--cross", options.cross, "paths of other seeds to score each run on, instead of the script's");
  run->add_flag("--ablate", options.ablate, "run every strategy with each of its guides taken out, too");
  run->add_option("--json", options.json, "write all figures to a file");
  run->add_option("--html", options.html, "write a page that shows the results and replays the runs");
  run->add_option("--samples", options.samples, "write all samples and paths into a folder");
  run->add_option("--figures", options.figures, "draw the results into a folder");
  run->add_option("--out", options.out, "write tables, the document and figures into a folder, problem by problem");
  run->add_option("--learn", options.learn, "add the paths that were found and are new to a library of paths");
  run->add_option(
      "--novelty", options.novelty,
      "how far from all that the library has a path is new, in metres (default the robot's bounding radius)");
  run->add_option("--palette", options.palette,
                  "the figures' colours of samples: safe, for any colour vision, or paper");
  add_figure_options(run, options.style);
  run->add_option("--report", options.report, "what is printed: overview (default), levels, efficiency or full");
  run->add_flag("--full", options.full, "as --report full");
  run->add_flag("--quiet", options.quiet, "print neither report nor progress");

  add_script_options(run, options.scripts);

  command::MeasureOptions measuring;
  auto* measure = app.add_subcommand("measure", "measure samples that any program drew, and print the figures");
  measure->add_option("CASE", measuring.file, "a case file: the space, the path, and where the samples are")
      ->required();
  measure->add_option("--json", measuring.json, "write all figures to a file, - for the standard output");
  measure->add_option("--estimator", measuring.estimator, "the estimator instead of knn, or all");

  add_script_options(measure, measuring.scripts);

  command::CompareOptions comparing;
  auto* compare =
      app.add_subcommand("compare", "compare what strategies cost, seed by seed, in results of trellis run");
  compare->add_option("RESULTS", comparing.files, "documents that trellis run --json wrote")->required();
  compare->add_option("--baseline", comparing.baseline,
                      "the strategy that the others are compared with, instead of the experiment's");
  compare->add_option("--out", comparing.out, "write tables and figures into a folder");
  add_figure_options(compare, comparing.style);

  command::VerifyOptions verifying;
  auto* verify = app.add_subcommand("verify", "validate the paths in results of trellis run again, more finely");
  verify->add_option("RESULTS", verifying.files, "documents that trellis run --json wrote")->required();
  verify->add_option("--script", verifying.script, "the script of the results, instead of the one that they name");
  verify->add_option("--seed", verifying.seed, "the --seed that trellis run had, where the script makes random worlds");
  add_script_options(verify, verifying.scripts);

  std::vector<std::string> scripts;
  command::ScriptOptions checking;
  auto* check = app.add_subcommand("check", "validate scripts without planning and print their strategies");
  check->add_option("SCRIPT", scripts, "Lua scripts")->required();
  add_script_options(check, checking);

  command::ExplainOptions explaining;
  auto* explain = app.add_subcommand("explain", "print what strategies will run, level by level, without planning");
  explain->add_option("SCRIPT", explaining.script, "a Lua script")->required();
  explain->add_option("--strategy", explaining.strategy, "the strategy of this name alone");
  explain->add_option("--problem", explaining.problem,
                      "the problem of this name, instead of the first one in each space");
  explain->add_option("--json", explaining.json, "write the same for programs to a file, - for the standard output");
  explain->add_option("--width", explaining.width, "columns of the text (default those of the terminal, else 100)");
  add_script_options(explain, explaining.scripts);

  command::TestOptions testing;
  auto* test = app.add_subcommand("test", "run the scenarios of scripts and say what holds");
  test->add_option("SCRIPT", testing.files, "Lua scripts of scenarios")->required();
  test->add_option("--filter", testing.filter, "only the scenarios whose names contain this");
  test->add_option("--seeds", testing.seeds, "the number of seeds of every trial, instead of the script's");
  test->add_option("--jobs", testing.jobs, "runs at the same time (default all cores)");
  test->add_option("--junit", testing.junit, "write what came out as JUnit's XML");
  add_script_options(test, testing.scripts);

  std::string library;
  bool list = false;
  auto* experience = app.add_subcommand("experience", "print what is in a library of paths");
  experience->add_option("LIBRARY", library, "a file as trellis run --learn makes it")->required();
  experience->add_flag("--list", list, "a line for each path, not for each problem");

  command::TrainOptions training;
  auto* train = app.add_subcommand("train", "train a heuristic to imitate exact search on worlds");
  train->add_option("--data", training.data, "a folder of families, each with the folders train and validation of PNGs")
      ->required();
  train->add_option("--out", training.out, "the file that the model is written to")->required();
  train->add_option("--family", training.families, "families to train on, separated by commas, instead of all")
      ->delimiter(',');
  train->add_option("--seed", training.seed, "of the samples and the forest (default 1)");
  train->add_flag("--search", training.search,
                  "train a heuristic of best_first on searches of the worlds' grids, instead of learned's classifier");
  train->add_option("--samples", training.samples,
                    "cells drawn from each world (default 500); with --search, vertices from each search (default 60)");
  train->add_option("--cells", training.cells,
                    "cells of the grid along a world's longer side, for --search (default 40)");
  train->add_option("--rounds", training.rounds, "rounds of data aggregation, for --search (default 10)");
  train->add_flag("--quiet", training.quiet, "print neither figures nor progress");

  std::string fresh;
  auto* create = app.add_subcommand("new", "write a small script to begin with, and its test");
  create
      ->add_option("NAME", fresh,
                   "the script is NAME.lua, its test NAME_test.lua; files that exist are left as they are")
      ->required();
  std::string first;
  auto* repl = app.add_subcommand("repl", "an interactive session: plan, step through runs, draw them");
  repl->add_option("SCRIPT", first, "a Lua script to begin with");
  command::ScriptOptions sitting;
  add_script_options(repl, sitting);

  const auto* version = app.add_subcommand("version", "print the version");

  std::string topic;
  auto* help = app.add_subcommand("help", "print what is known about a word of the language");
  help->add_option("TOPIC", topic, "a planner, guide, constructor or module");

  std::string form;
  auto* reference =
      app.add_subcommand("reference", "print all words of the language, for reading or for other programs");
  reference->add_option(
      "FORM", form,
      "markdown (the default), stubs for lua-language-server, luacheck's configuration, words, one a line; "
      "of the command line: man, the manual page, or the completion for bash, fish or zsh");

  command::name_values(app);
  const std::string usage = app.help();  // after parsing, help() returns that of the subcommand
  const auto unknown_option = [&](const std::string& word) {
    std::vector<std::string> known;
    for (const auto* parsed : app.get_subcommands()) {
      for (const auto* option : parsed->get_options()) {
        for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
      }
    }
    return fmt::format("no option {}{}", word, did_you_mean(word, known));
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)) {
      const auto words = app.remaining(true);
      const auto word = std::find_if(words.begin(), words.end(), [](const auto& w) { return w.starts_with("--"); });
      if (word != words.end()) throw Error(unknown_option(*word) + "; 'trellis help' shows the usage");
    }
    throw Error(std::string(error.what()) + "; 'trellis help' shows the usage");
  }
  for (const auto* parsed : {run, measure, compare, verify, check, explain, test}) {
    for (const auto* option : parsed->get_options()) {
      const bool empty = option->count() > 0 && option->get_expected_max() > 0 && option->as<std::string>().empty();
      if (empty) throw Error(fmt::format("{} is empty", option->get_name()));
    }
  }
  if (run->parsed()) return command::run(options);
  if (measure->parsed()) return command::measure(measuring);
  if (compare->parsed()) return command::compare(comparing);
  if (verify->parsed()) return command::verify(verifying);
  if (check->parsed()) return command::check(scripts, checking);
  if (explain->parsed()) return command::explain(explaining);
  if (test->parsed()) return command::test(testing);
  if (experience->parsed()) return command::experience(library, list);
  if (train->parsed()) return command::train(training);
  if (create->parsed()) return command::create(fresh);
  if (reference->parsed()) return command::reference(form, app);
  if (repl->parsed()) return command::repl(first, sitting);
  if (version->parsed()) return command::version();
  return command::help(topic, usage);
}

}  // namespace

int main(int argc, char** argv) {
  command::catch_interrupts();
  try {
    return dispatch(argc, argv);
  } catch (const Interrupted& interrupted) {
    fmt::print(stderr, "trellis: {}\n", interrupted.what());
    return command::was_interrupted;
  } catch (const Error& error) {
    fmt::print(stderr, "trellis: {}\n", error.what());
    return command::their_fault;
  } catch (const std::exception& error) {
    fmt::print(stderr, "trellis: a fault of trellis itself, please report it: {}\n", error.what());
    return command::our_fault;
  }
}
