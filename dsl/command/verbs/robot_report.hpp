// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace trellis::command {

/// Returns what is in a URDF or SRDF file, as text or JSON; none for another file. Of a URDF file NAME.urdf it also
/// reads NAME.srdf beside it, and of a SRDF file the robot.
/// \param shown  the file's name in the report
/// \param robot  the URDF file of a SRDF file; "" for NAME.urdf beside it
/// \throws Error with file and line
std::optional<std::string> robot_report(const std::string& path, const std::string& shown, const std::string& robot,
                                        bool json);

}  // namespace trellis::command
