// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace trellis::command {

/// The exit statuses of the command line; `trellis test` returns 1 for a failed expectation. The last one is the
/// shell's convention for Ctrl-C.
enum Exit : int { success = 0, our_fault = 1, tests_failed = 1, their_fault = 2, was_interrupted = 130 };

/// Permissions and limits of a script.
struct ScriptOptions {
  std::string memory;        ///< MiB as typed, "" if not given
  std::string instructions;  ///< as typed, "" if not given
  bool trust = false;
};

/// The style of figures and tables, for papers.
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
  std::string seeds;  ///< as typed, "" if not given
  std::string seed;
  std::string only;      ///< one seed, as typed, "" if not given
  std::string problem;   ///< a name, "" for all
  std::string strategy;  ///< likewise
  std::string jobs;
  std::string cross;
  std::string json;     ///< a file, "" if not given
  std::string html;     ///< a file, "" if not given
  std::string samples;  ///< a folder, "" if not given
  std::string figures;  ///< a folder, "" if not given
  std::string out;      ///< a folder for tables, figures and the document, "" if not given
  std::string learn;    ///< a library of paths, "" if not given
  std::string novelty;  ///< metres as typed, "" if not given
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
  std::string seed;                   ///< as typed, "" if not given
  std::string samples;
  std::string cells;
  std::string rounds;
  bool search = false;  ///< a search heuristic instead of a classifier of cells
  bool quiet = false;
};

struct MeasureOptions {
  std::string file;       ///< the case
  std::string json;       ///< a file, "-" for stdout, "" if not given
  std::string estimator;  ///< a name, "all", "" for the default
  ScriptOptions scripts;
};

struct CompareOptions {
  std::vector<std::string> files;  ///< documents of trellis run --json
  std::string baseline;            ///< a strategy, "" for the one that the documents name
  std::string out;                 ///< a folder, "" if not given
  FigureOptions style;
};

struct VerifyOptions {
  std::vector<std::string> files;  ///< documents of trellis run --json
  std::string script;              ///< replaces the script that the documents name, "" if not given
  std::string seed;                ///< of math.random while the script loads, as typed, "" if not given
  ScriptOptions scripts;
};

struct ExplainOptions {
  std::string script;
  std::string strategy;  ///< a name, "" for all
  std::string problem;   ///< likewise
  std::string json;      ///< a file, "-" for stdout, "" if not given
  std::string width;     ///< columns as typed, "" for the terminal's
  ScriptOptions scripts;
};

struct TestOptions {
  std::vector<std::string> files;
  ScriptOptions scripts;
  std::string junit;   ///< a file, "" if not given
  std::string seeds;   ///< as typed, "" if not given
  std::string jobs;    ///< as typed, "" if not given
  std::string filter;  ///< a part of the names of the scenarios to run
};

// Each command returns the exit status, and throws Error for faults that the user can correct.

/// Runs a script's experiment, prints the report and writes the requested files.
int run(const RunOptions& options);
/// Measures samples of any program relative to a tube, as a case file states, and prints the values.
int measure(const MeasureOptions& options);
/// Compares the costs of the strategies in documents of results, prints them, and writes tables and figures.
int compare(const CompareOptions& options);
/// Validates the paths in documents of results again, at a finer resolution and with the other collision backend, and
/// prints each fault.
int verify(const VerifyOptions& options);
/// Prints the content of a library of paths: a line for each problem, or for each path.
int experience(const std::string& file, bool list);
/// Loads scripts without planning and prints their strategies as trees.
int check(const std::vector<std::string>& scripts, const ScriptOptions& options);
/// Prints the hierarchy and settings of a script's strategies on its problems, level by level, without planning.
int explain(const ExplainOptions& options);
/// Runs the scenarios of scripts, and prints which expectations are met.
int test(const TestOptions& options);
/// Trains a heuristic to imitate exact search on a folder of worlds, writes it, and prints its performance on other
/// worlds.
int train(const TrainOptions& options);
/// Writes NAME.lua, a small example script, and NAME_test.lua, its scenarios, unless such files exist.
int create(const std::string& name);
/// Runs an interactive session, after a script if one is given; reads lines from stdin if that is no terminal.
int repl(const std::string& script, const ScriptOptions& options);
/// Prints the help on a word of the language; for "", `usage` and all words.
int help(const std::string& topic, const std::string& usage);
/// Prints all words, or the command line, in a format for other programs: one of `reference_forms`, the first for "".
int reference(const std::string& form, const CLI::App& app);
const std::vector<std::string>& reference_forms();
int version();

}  // namespace trellis::command
