// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace trellis::command {

/// The exit statuses of the command line; `trellis test` returns 1 for a failed expectation. The last one is the
/// shell's convention for a closed pipe, 128 + SIGPIPE; interrupted_status() has those of other signals.
enum Exit : int { success = 0, our_fault = 1, tests_failed = 1, their_fault = 2, pipe_closed = 141 };

class CommandLine;

// Each function adds a verb, with its options and what it does. Verbs throw Error for faults that the user can correct.

void add_run(CommandLine& line);
void add_sweep(CommandLine& line);
void add_merge(CommandLine& line);
void add_measure(CommandLine& line);
void add_tune(CommandLine& line);
void add_report(CommandLine& line);
void add_verify(CommandLine& line);
void add_check(CommandLine& line);
void add_explain(CommandLine& line);
void add_test(CommandLine& line);
void add_scene(CommandLine& line);
void add_experience(CommandLine& line);
void add_new(CommandLine& line);
void add_repl(CommandLine& line);
void add_version(CommandLine& line);
void add_help(CommandLine& line);
void add_reference(CommandLine& line);

/// In the order of the help.
inline constexpr std::array subcommands = {
    add_run,  add_sweep, add_merge,      add_measure, add_tune, add_report,  add_verify, add_check,    add_explain,
    add_test, add_scene, add_experience, add_new,     add_repl, add_version, add_help,   add_reference};

}  // namespace trellis::command
