// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/interrupt.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>

int main(int argc, char** argv) {
  using namespace trellis;  // NOLINT(google-build-using-namespace): the program's own
  command::catch_interrupts();
  try {
    command::CommandLine line;
    for (const auto add : command::subcommands) add(line);
    return line.run(argc, argv);
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
