// SPDX-License-Identifier: GPL-3.0-or-later
// Spaces and the places of robots in them as plain data, for sources that include the JSON library.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include <trellis/pictures/traces.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// Returns of each coordinate its name, ends, whether it is periodic, and its weight.
nlohmann::ordered_json axes_json(const Space& space);
/// Returns the first column of each rotation of space.
nlohmann::ordered_json rotations_json(const Space& space);
/// Returns where configurations have the position of each robot.
nlohmann::ordered_json traces_json(const std::vector<Trace>& traces);

}  // namespace trellis
