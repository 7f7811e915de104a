// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/base/configurations.hpp>

namespace trellis::command {

/// Reads a file of comma-separated numbers below a header line that names the columns, in any order. Returns a row for
/// each line, with its coordinates in the order of `columns`. Lines may end with CR LF, cells may have blanks around
/// them, and a byte order mark is skipped.
/// \param named_by  the origin of the file's name, for the message if it cannot be read: "case.json: samples"
/// \throws Error with file, line and column for other content, including numbers that are not finite, and for a file
///     without rows.
Configurations read_csv(const std::string& path, const std::vector<std::string>& columns, const std::string& named_by);

}  // namespace trellis::command
