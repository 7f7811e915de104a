// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include <trellis/base/error.hpp>

namespace trellis {

/// Calls `join(robot, first, number)` for the robots of a team, with the first of its coordinates; a team among them
/// joins with its members.
/// \param instead  of a point: "disc"
/// \throws Error for less than two robots, more than R::most_members, or a point
template <class R, class Join>
void join_members(const std::vector<R>& robots, const char* instead, const Join& join) {
  std::size_t first = 0;
  std::size_t number = 0;
  const auto add = [&](const R& robot) {
    ++number;
    if (robot.is_point()) {
      throw Error(fmt::format("robots: robot {} is a point, which nothing can touch; use a small {}", number, instead));
    }
    join(robot, first, number);
    first += robot.dimension();
  };
  for (const R& robot : robots) {
    if (robot.members().empty()) add(robot);
    for (const auto& member : robot.members()) add(*member.robot);
  }
  if (number < 2) throw Error("robots: a team has at least two robots");
  if (number > R::most_members) {
    throw Error(fmt::format("robots: at most {} robots in a team, got {}", R::most_members, number));
  }
}

}  // namespace trellis
