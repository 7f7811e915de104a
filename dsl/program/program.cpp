// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/outputs.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/program.hpp>

namespace trellis {

int run_program(int argc, char** argv) {
  command::catch_signals();
  try {
    command::CommandLine line;
    for (const auto add : command::subcommands) add(line);
    const int status = line.run(argc, argv);
    command::finish_output();
    return command::output_closed() ? command::pipe_closed : status;
  } catch (const Interrupted& interrupted) {
    fmt::print(stderr, "trellis: {}\n", interrupted.what());
    return command::interrupted_status();
  } catch (const Error& error) {
    command::print_error(error);
    return command::output_closed() ? command::pipe_closed : command::their_fault;
  } catch (const std::bad_alloc&) {
    fmt::print(
        stderr,
        "trellis: the system gives no more memory; expected fewer seeds, proposals or obstacles, or one --problem "
        "and --strategy\n");
    return command::their_fault;
  } catch (const std::exception& error) {
    fmt::print(stderr, "trellis: a fault of trellis itself, please report it: {}\n", error.what());
    return command::our_fault;
  }
}

}  // namespace trellis
