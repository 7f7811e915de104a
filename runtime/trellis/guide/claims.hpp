// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace trellis {

/// What a guiding space claims of itself: told by help and the catalogue, and held to by the laws in the tests.
struct GuideClaims {
  /// The families of the paper.
  enum class Category : std::uint8_t { trivial, robot, environment, experience, sampling, combinator };
  /// What h goes by where S holds no path.
  enum class Fallback : std::uint8_t {
    none,     ///< S = {0}: there is nothing to search
    nearest,  ///< the way to what came nearest to the goal
    own,      ///< as the text says
  };

  /// What a guide asks of the space that it guides in; it refuses any other.
  enum class Needs : std::uint8_t {
    nothing,
    position,       ///< a reference point of the robot that moves in the plane, or the tip of an arm
    position_axes,  ///< a reference point that two axes of the space move
    robot_axes,     ///< axes that are the robot's own
  };

  Category category = Category::sampling;
  std::string f;             ///< in a line
  std::string h;             ///< in a line
  bool closed_form = false;  ///< of the density
  std::string density;       ///< of what
  std::string feedback;      ///< what observe and learn do
  bool relaxes = true;       ///< f maps what is valid in C to what is valid in S
  std::string invalid_ends;  ///< what becomes of a start or goal that f maps to what is invalid in S
  Fallback fallback = Fallback::none;
  std::string no_path;  ///< what happens where S has no path
  std::string example;  ///< a script: "examples/nested.lua"
  Needs needs = Needs::nothing;
  bool relaxes_arms = true;  ///< where it relaxes: also for a robot that is fixed to its base
};

/// "robot modification".
std::string_view to_string(GuideClaims::Category category);
/// "a robot whose reference point moves in the plane"; "" for nothing.
std::string_view to_string(GuideClaims::Needs needs);

}  // namespace trellis
