// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis::dsl {

/// The words of the language that may end a line where its last name stands, sorted. They stand for that name, without
/// what comes before its last dot; an option comes with its sign, "step = ", and alone where nothing else may stand.
std::vector<std::string> offers(const std::string& line_up_to_cursor);

}  // namespace trellis::dsl
