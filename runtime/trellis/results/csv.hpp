// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis {

/// Returns a name as a cell of a CSV file: in quotes where it has a comma, a quote or a line break. Spreadsheets take a
/// text that begins with =, +, -, @, a tab or a carriage return for a formula: such a name gets an apostrophe before
/// it, and quotes. A number, as "-5", is none.
std::string csv_text(const std::string& text);

}  // namespace trellis
