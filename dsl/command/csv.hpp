// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/base/configurations.hpp>

namespace trellis::command {

/// Reads a file of comma-separated numbers below a header line that names the columns, in any order: a row for each
/// line, its coordinates in the order of `columns`. Lines may end with CR LF, cells may be padded, a byte order mark is
/// skipped. Throws Error with file, line and column for anything else, numbers that are not finite among it, and for a
/// file without rows.
/// \param named_by  what named the file, for the message where it cannot be read: "case.json: samples"
Configurations read_csv(const std::string& path, const std::vector<std::string>& columns, const std::string& named_by);

}  // namespace trellis::command
