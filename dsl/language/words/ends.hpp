// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <dsl/lua/value.hpp>
#include <trellis/instance/resolve_goal.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

// Values of the language that mean configurations of a robot: lists of numbers, coordinates by name, named states,
// poses, links at poses (reach), and for a team a list with one of these for each robot.

namespace trellis::dsl {

/// Of each robot of a team the coordinates of a configuration, with those of its velocities.
std::vector<std::vector<std::size_t>> columns_of(const Problem& problem);

/// Reads one configuration. Coordinates of lines within 1e-6 of a bound are moved to it.
/// \param problem  with scene, space and motion model
/// \param what     names the value in messages: "problem: field 'start'"
/// \throws Error; also for reach { ... }
Configuration read_place(lua::Value value, const std::string& what, const Problem& problem);

/// Reads a start. Of the configurations of reach { ... } the one nearest to the middle of the bounds is chosen.
/// \throws Error; InvalidEnd where inverse kinematics finds none
Configuration read_start(lua::Value value, const Problem& problem);

/// Reads one goal or a list of goals. Each reach { ... } gives up to ten, those nearest to the problem's start first.
/// \param warnings  receives those about goals that nothing reaches, where another one is reached
/// \throws Error; InvalidEnd where inverse kinematics finds none for any goal
std::vector<Configuration> read_goals(lua::Value value, const Problem& problem, std::vector<std::string>& warnings);

/// Covers links with finer balls where the start or a goal needs it (trellis::fit_covers).
/// \param warnings  receives which links
void fit_covers_to_ends(Problem& problem, std::vector<std::string>& warnings);

/// Returns "; angles are radians: write math.rad(90)" where a joint's angle in one of the configurations is out of its
/// bounds by more than a full turn, else "".
std::string degrees_hint(const Problem& problem, const std::vector<Configuration>& ends);
/// The same sentence for a number that is probably an angle in degrees.
std::string radians_sentence(double degrees);

/// Returns the link with that name. \throws Error with the nearest name
std::size_t link_named(const SphereModel& robot, const std::string& name, const std::string& what);

}  // namespace trellis::dsl
