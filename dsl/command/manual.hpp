// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

// What is made from the command line's own description: the manual page, and what shells complete it with. The type
// name of an option says what its value is: FILE, FOLDER, or alternatives as "safe|paper".

namespace trellis::command {

/// Names the values of all options and arguments, for help and for what follows.
void name_values(CLI::App& app);

/// The manual page trellis(1), in roff.
std::string manual(const CLI::App& app);

/// The shells that there is a completion for.
const std::vector<std::string>& shells();
/// The completion of verbs, options, files and words of the language for one of `shells`.
std::string shell_completion(const std::string& shell, const CLI::App& app);

}  // namespace trellis::command
