// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/team_times.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace trellis {

Space space_of(const Space& team, const TeamMember& member) {
  std::vector<Axis> axes;
  axes.reserve(member.axes.size());
  for (const std::size_t axis : member.axes) axes.push_back(team.axes()[axis]);
  return {fmt::format("robot {}", member.number), std::move(axes)};
}

TeamTimes times_of(const Space& space, const std::vector<TeamMember>& members, const Configurations& path) {
  TeamTimes times;
  times.at.assign(path.size(), 0.0);
  std::vector<Space> own;
  own.reserve(members.size());
  for (const TeamMember& member : members) own.push_back(space_of(space, member));
  std::vector<double> arrived(members.size(), 0.0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    double longest = 0.0;
    std::vector<char> moves(members.size(), 0);
    for (std::size_t r = 0; r < members.size(); ++r) {
      const auto part = [&](View q) {
        Configuration own_part;
        for (const std::size_t axis : members[r].axes) own_part.push_back(q[axis]);
        return own_part;
      };
      const double moved = own[r].distance(part(path[i - 1]), part(path[i]));
      moves[r] = moved > 0.0 ? 1 : 0;
      longest = std::max(longest, moved);
    }
    times.at[i] = times.at[i - 1] + longest;
    for (std::size_t r = 0; r < members.size(); ++r) {
      if (moves[r] != 0) arrived[r] = times.at[i];
    }
  }
  for (const double time : arrived) {
    times.makespan = std::max(times.makespan, time);
    times.sum_of_costs += time;
  }
  return times;
}

}  // namespace trellis
