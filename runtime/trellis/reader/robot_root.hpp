// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include <trellis/reader/xml_entry.hpp>

namespace trellis {

/// Returns the element `<robot>` of a URDF or SRDF file.
/// \param expected  what the file would be, in messages: "a URDF file"
/// \throws Error where the text is no XML, has another outermost element (messages name SDF and MJCF files), or is of
///     xacro: then the message has the command that expands it
XmlEntry robot_root(const SourceText& text, const char* expected);

/// What a file describes of a robot.
enum class RobotFile : std::uint8_t { none, urdf, srdf };

/// Returns what a file is by its ending and its elements. \throws Error as robot_root, for files whose ending is .urdf,
///     .srdf or .xacro
RobotFile robot_file(const std::string& path);

/// Returns the command that expands a xacro file: "xacro arm.urdf.xacro > arm.urdf".
std::string xacro_command(const std::string& path);

}  // namespace trellis
