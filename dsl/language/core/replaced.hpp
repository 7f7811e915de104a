// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis::dsl {

/// Returns what a message says after an unknown name: what replaces a word of an earlier version, else the nearest of
/// the known names, "" for none.
/// \param module  whose field it is, "" for a word alone
std::string suggestion(const std::string& name, const std::vector<std::string>& known, const std::string& module = "");

}  // namespace trellis::dsl
