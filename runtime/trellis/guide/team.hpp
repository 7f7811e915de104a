// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

class RobotsPath;

/// How a guide of a team finds the path of the whole team.
enum class Coordination : std::uint8_t {
  alone,      ///< each robot finds a path alone; then all move along theirs, and only when is searched
  order,      ///< one robot after another, each with those before it, which move along the path found
  conflicts,  ///< as `alone`; robots whose paths cannot be passed one after the other are joined and plan together
  windows     ///< as `alone`; robots leave their paths only about a conflict, and plan together there
};

/// How the search of S divides by robots.
struct TeamDivision {
  Coordination how = Coordination::alone;
  std::vector<std::size_t> order;           ///< of `order`: the members, from 0 on; all of them, but those of `given`
  std::shared_ptr<const RobotsPath> given;  ///< of `order`: a path that the other members follow; nullptr: none
  std::int64_t tries = 1;
  std::int64_t effort = 1;  ///< proposals of each search
  bool of_window = false;   ///< it resolves a conflict of another division
};

/// The division of a guide of the registry.
/// \param members  of the team
/// \throws Error where the options name a robot that the team has not
TeamDivision division_of(const std::string& guide, const Options& options, const std::vector<TeamMember>& members);

/// The axes of members of a team, ascending.
std::vector<std::size_t> axes_of(const std::vector<TeamMember>& members, const std::vector<std::size_t>& chosen);

/// The members that an option names by their numbers.
/// \param owner  names it in messages: "team"
/// \throws Error for a number that no member has, or that is there twice
std::vector<std::size_t> members_named(const std::string& owner, const std::vector<std::string>& numbers,
                                       const std::vector<TeamMember>& members);

}  // namespace trellis
