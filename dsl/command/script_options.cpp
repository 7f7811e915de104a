// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/script_options.hpp>

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include <dsl/command/interrupt.hpp>
#include <dsl/command/numbers.hpp>

namespace trellis::command {

dsl::SessionOptions session_options(const ScriptOptions& options) {
  constexpr std::uint64_t least_memory = 16, most_memory = std::uint64_t{1} << 20U;  // MiB
  constexpr std::uint64_t least_instructions = 1000, most_instructions = 1'000'000'000'000'000;
  const auto memory = integer_option("--memory", options.memory, least_memory, most_memory);
  const auto instructions =
      integer_option("--instructions", options.instructions, least_instructions, most_instructions);
  dsl::SessionOptions session;
  if (memory) session.memory = *memory << 20U;
  session.instructions = instructions.value_or(session.instructions);
  session.trust = options.trust;
  session.interrupted = InterruptibleRun::requested;
  session.stuck = [](const std::string& message) {
    fmt::print(stderr, "trellis: {}\n", message);
    std::fflush(stderr);
    ::_exit(their_fault);
  };
  return session;
}

}  // namespace trellis::command
