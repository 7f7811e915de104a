// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>

#include <exception>
#include <new>
#include <string>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/interrupt.hpp>
#include <dsl/command/store/outputs.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/program.hpp>
#include <trellis/results/files.hpp>

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
    command::print_message(interrupted.what());
    return command::interrupted_status();
  } catch (const Error& error) {
    command::print_error(error);
    return command::output_closed() ? command::pipe_closed : command::their_fault;
  } catch (const std::bad_alloc&) {
    // Formatting may need memory.
    static_cast<void>(write_all(STDERR_FILENO,
                                "trellis: the system gives no more memory; expected fewer seeds, proposals or "
                                "obstacles, or one --problem and --strategy\n"));
    return command::their_fault;
  } catch (const std::exception& error) {
    command::print_message(std::string("a fault of trellis itself, please report it: ") + error.what());
    return command::our_fault;
  }
}

}  // namespace trellis
