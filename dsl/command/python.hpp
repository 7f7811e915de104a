// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis::command {

/// A module of the Python package trellis (python/trellis) that runs as a command.
struct PythonModule {
  const char* name;                 ///< "trellis.figures"
  const char* subject;              ///< what it does, for messages: "figures"
  std::vector<const char*> needed;  ///< the modules of others that it imports
  const char* missing;              ///< the message where no Python has them
};

/// Runs `python3 -m NAME ARGUMENTS...` and returns what it printed. The Python is that of TRELLIS_PYTHON, else the
/// first python3 that has what the module needs.
/// \param own  a document that the user has not named, so that no message names it; "": none
/// \throws Error where Python or what it needs is missing, and with the message of the module
std::string run_python(const PythonModule& module, const std::vector<std::string>& arguments,
                       const std::string& own = "");

}  // namespace trellis::command
