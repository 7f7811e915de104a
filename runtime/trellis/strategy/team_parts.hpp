// SPDX-License-Identifier: GPL-3.0-or-later
// What the searches share that divide the instance of a team by its robots.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/scene/scene.hpp>
#include <trellis/strategy/level.hpp>

namespace trellis {

/// The displacement at which a certificate of a motion gives up, in metres.
double exact_tolerance_of(const Instance& instance);

/// The displacement at which a certificate of a motion that could as well be left out gives up: one that comes closer
/// to another robot takes hundreds of checks to certify, and leaves the next robots no room.
double coarse_tolerance_of(const Instance& instance);

/// Whether a path is certified; its instance pays for the checks.
bool certified(Instance& instance, const Configurations& path);

/// "robot 3", "robots 2, 5".
std::string name_of(const std::vector<TeamMember>& members, const std::vector<std::size_t>& robots);

/// The path found by a search of robots with its detours cut: later searches follow it.
Configurations shortened(const Run& run, Level& level);

/// Adds the checks of a part's instance to those of the team's.
void count_checks(const Instance& part, Instance& team);

}  // namespace trellis
