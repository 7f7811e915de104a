// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

// The manual page and the shell completions, generated from the description of the command line. The type name of an
// option describes its value: FILE, FOLDER, or alternatives as "safe|paper".

namespace trellis::command {

/// Returns the manual page trellis(1), in roff.
std::string manual(const CLI::App& app);

/// Returns the shells with a completion.
const std::vector<std::string>& shells();
/// Returns the completion of commands, options, files and words of the language for one of `shells`.
std::string shell_completion(const std::string& shell, const CLI::App& app);

}  // namespace trellis::command
