// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>

namespace trellis::command {

/// Returns the commit of the sources: "1a2b3c4d5e6f", with "-dirty" where files were changed since; "" where they were
/// no git repository.
std::string commit();

/// Returns "0.2.0 (1a2b3c4d5e6f)", or the version alone where the commit is not known.
std::string version_and_commit();

/// Describes the machine: `system`, `processor`, `cores`, `compiler`. Fields that are not known are "".
std::map<std::string, std::string> machine();

}  // namespace trellis::command
