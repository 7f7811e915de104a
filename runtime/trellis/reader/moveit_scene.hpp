// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/moveit_objects.hpp>
#include <trellis/reader/robot_files.hpp>

namespace trellis {

// The two formats of planning scenes of MoveIt; callers use read_moveit.

/// Reads a scene in YAML, and the request beside it.
MoveitFile read_moveit_yaml(const SourceText& text, const SphereModel& robot, const MoveitOptions& options);
/// Reads what is in a scene in YAML without a robot: its objects, in frames that are at the origin unless the scene
/// defines them.
void describe_moveit_yaml(const SourceText& text, MoveitObjects& objects, std::vector<std::string>& notes,
                          std::vector<std::string>& warnings);
/// Returns the world of a scene's objects. \throws Error with the file
World3 moveit_world(const MoveitObjects& objects, const SphereModel* robot, const std::string& path);
/// The name of the robot that a scene in YAML is for; "" where it gives none.
std::string moveit_robot(const SourceText& text);

/// Reads the text that RViz exports: a name, then objects, which begin with a star, then a full stop.
void read_moveit_text(const SourceText& text, MoveitObjects& objects, std::vector<std::string>& warnings);

}  // namespace trellis
