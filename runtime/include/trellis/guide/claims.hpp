// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace trellis {

/// The documented properties of a guiding space. Help and catalogue print them; tests verify them.
struct GuideClaims {
  /// The families of guiding spaces in the paper.
  enum class Category : std::uint8_t { trivial, robot, environment, experience, sampling, combinator };
  /// How h guides if S has no path.
  enum class Fallback : std::uint8_t {
    none,     ///< S = {0}: there is no search
    nearest,  ///< along the path to the node nearest to the goal
    own,      ///< as described in `no_path`
  };

  /// What a guide requires of the space that it guides in. It rejects other spaces.
  enum class Needs : std::uint8_t {
    nothing,
    position,       ///< a reference point of the robot that moves in the plane, or the tip of an arm
    position_axes,  ///< a reference point whose position is two axes of the space
    robot_axes,     ///< axes that are axes of the robot
    team,           ///< a team of robots
  };

  Category category = Category::sampling;
  std::string f;             ///< description, one line
  std::string h;             ///< description, one line
  bool closed_form = false;  ///< whether h has a closed density
  std::string density;       ///< description of h's density
  std::string feedback;      ///< description of `observe` and `learn`
  bool relaxes = true;       ///< whether f maps every valid configuration of C to a valid one of S
  std::string invalid_ends;  ///< description: a start or goal that f maps to an invalid configuration of S
  Fallback fallback = Fallback::none;
  std::string no_path;  ///< description: S has no path
  std::string example;  ///< a script: "examples/nested.lua"
  Needs needs = Needs::nothing;
};

/// The name of the category, as "robot modification".
/// \param category  a value of the enumeration
/// \throws Fault for another value
std::string_view to_string(GuideClaims::Category category);
/// The requirement, as "a robot whose reference point moves in the plane"; "" for `nothing`.
/// \param needs  a value of the enumeration
/// \throws Fault for another value
std::string_view to_string(GuideClaims::Needs needs);

}  // namespace trellis
