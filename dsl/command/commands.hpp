// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace trellis::command {

/// What the command line answers with; `trellis test` says with 1 that something did not hold. The last one is the
/// shell's convention for a Ctrl-C.
enum Exit : int { success = 0, our_fault = 1, tests_failed = 1, their_fault = 2, was_interrupted = 130 };

/// What a script may do and spend.
struct ScriptOptions {
  std::string memory;        ///< MiB as typed, "" without
  std::string instructions;  ///< as typed, "" without
  bool trust = false;
};

/// How figures and tables are set, for papers.
struct FigureOptions {
  std::string column;  ///< width in millimetres as typed, "" for each figure's own
  bool untitled = false;
  bool serif = false;
  bool scale_bar = false;
  std::string format;  ///< of tables, "" for Markdown
};

struct RunOptions {
  std::string script;
  ScriptOptions scripts;
  std::string seeds;  ///< as typed, "" without
  std::string seed;
  std::string only;      ///< one seed, as typed, "" without
  std::string problem;   ///< a name, "" for all
  std::string strategy;  ///< likewise
  std::string jobs;
  std::string cross;
  std::string json;     ///< a file, "" without
  std::string html;     ///< a file, "" without
  std::string samples;  ///< a folder, "" without
  std::string figures;  ///< a folder, "" without
  std::string out;      ///< a folder for tables, figures and the document, "" without
  std::string learn;    ///< a library of paths, "" without
  std::string novelty;  ///< metres as typed, "" without
  std::string palette;  ///< of the figures, "" for the default
  FigureOptions style;
  std::string report;  ///< a kind of report, "" for the overview
  bool full = false;   ///< the full report
  bool ablate = false;
  bool quiet = false;
};

struct TrainOptions {
  std::string data;                   ///< a folder of families
  std::string out;                    ///< a file
  std::vector<std::string> families;  ///< none: all
  std::string seed;                   ///< as typed, "" without
  std::string samples;
  std::string cells;
  std::string rounds;
  bool search = false;  ///< a search heuristic instead of a classifier of cells
  bool quiet = false;
};

struct MeasureOptions {
  std::string file;       ///< the case
  std::string json;       ///< a file, "-" for stdout, "" without
  std::string estimator;  ///< a name, "all", "" for the default
  ScriptOptions scripts;
};

struct CompareOptions {
  std::vector<std::string> files;  ///< documents of trellis run --json
  std::string baseline;            ///< a strategy, "" for the one that they name
  std::string out;                 ///< a folder, "" without
  FigureOptions style;
};

struct VerifyOptions {
  std::vector<std::string> files;  ///< documents of trellis run --json
  std::string script;              ///< instead of the one that the documents name, "" without
  std::string seed;                ///< of math.random while the script loads, as typed, "" without
  ScriptOptions scripts;
};

struct ExplainOptions {
  std::string script;
  std::string strategy;  ///< a name, "" for all
  std::string problem;   ///< likewise
  std::string json;      ///< a file, "-" for stdout, "" without
  std::string width;     ///< columns as typed, "" for the terminal's
  ScriptOptions scripts;
};

struct TestOptions {
  std::vector<std::string> files;
  ScriptOptions scripts;
  std::string junit;   ///< a file, "" without
  std::string seeds;   ///< as typed, "" without
  std::string jobs;    ///< as typed, "" without
  std::string filter;  ///< what the names of scenarios are to contain
};

// Each command returns the exit status, and throws Error for what the user can mend.

/// Runs a script's experiment, prints the report and writes the files that were asked for.
int run(const RunOptions& options);
/// Measures samples of any program's against a tube, as a case file says, and prints the figures.
int measure(const MeasureOptions& options);
/// Compares the costs of the strategies in documents of results, prints them, and writes tables and figures.
int compare(const CompareOptions& options);
/// Validates the paths in documents of results again, at a finer resolution and by the other collision backend, and
/// prints each fault.
int verify(const VerifyOptions& options);
/// Prints what is in a library of paths: a line for each problem, or for each path.
int experience(const std::string& file, bool list);
/// Loads scripts without planning and prints their strategies as trees.
int check(const std::vector<std::string>& scripts, const ScriptOptions& options);
/// Prints what the strategies of a script will run on its problems, level by level, without planning.
int explain(const ExplainOptions& options);
/// Runs the scenarios of scripts, and prints what holds and what does not.
int test(const TestOptions& options);
/// Trains a heuristic to imitate exact search on a folder of worlds, writes it, and prints what it is worth on others.
int train(const TrainOptions& options);
/// Writes NAME.lua, a small script to begin with, and NAME_test.lua, its scenarios, where there are no such files.
int create(const std::string& name);
/// An interactive session, after a script where one is named; lines from stdin where that is no terminal.
int repl(const std::string& script, const ScriptOptions& options);
/// Prints what is known about a word of the language; `usage` and all words where it is "".
int help(const std::string& topic, const std::string& usage);
/// Prints all words, or the command line, in a form for other programs: one of `reference_forms`, "" is the first.
int reference(const std::string& form, const CLI::App& app);
const std::vector<std::string>& reference_forms();
int version();

}  // namespace trellis::command
