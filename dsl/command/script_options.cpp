// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/script_options.hpp>

#include <fmt/format.h>
#include <unistd.h>

#include <dsl/command/commands.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/store/outputs.hpp>

namespace trellis::command {

void add_script_options(Subcommand& verb, ScriptOptions& options) {
  constexpr std::uint64_t least_memory = 16, most_memory = std::uint64_t{1} << 20U;  // MiB
  constexpr std::uint64_t least_instructions = 1000, most_instructions = 1'000'000'000'000'000;
  verb.integer("--memory", "MIB", least_memory, most_memory, options.memory,
               "the memory that a script may hold, in MiB (default 1024)");
  verb.integer("--instructions", "N", least_instructions, most_instructions, options.instructions,
               "what a script may work while it loads, in instructions (default 1000000000); each call of one of "
               "its functions later on a tenth");
  verb.flag("--trust", options.trust, "let scripts reach all files and processes: io, os, debug");
}

dsl::SessionOptions session_options(const ScriptOptions& options) {
  dsl::SessionOptions session;
  if (options.memory) session.memory = *options.memory << 20U;
  session.instructions = options.instructions.value_or(session.instructions);
  session.trust = options.trust;
  session.interrupted = InterruptibleRun::requested;
  session.stuck = [](const std::string& message) {
    print_message(message);
    ::_exit(their_fault);
  };
  return session;
}

}  // namespace trellis::command
