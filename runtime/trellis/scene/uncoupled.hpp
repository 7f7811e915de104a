// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <trellis/scene/scene.hpp>

namespace trellis {

/// Two robots of a team, by their numbers (TeamMember::number).
using RobotPair = std::pair<std::size_t, std::size_t>;

/// Returns the scene in which the two robots of each of some pairs pass through each other: their bodies are no
/// self-collision pairs any more. Scenes of guiding spaces that are made of it keep that. nullptr for a scene whose
/// team it cannot change.
std::shared_ptr<const Scene> uncoupled(const Scene& scene, const std::vector<RobotPair>& pairs);

}  // namespace trellis
