// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/team_times.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace trellis {

Space space_of(const Space& team, const TeamMember& member) {
  return team.part(member.axes, fmt::format("robot {}", member.number));
}

namespace {

void count_arrivals(const std::vector<double>& arrived, TeamTimes& times) {
  for (const double time : arrived) {
    times.makespan = std::max(times.makespan, time);
    times.sum_of_costs += time;
  }
}

}  // namespace

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
  count_arrivals(arrived, times);
  return times;
}

TeamTimes times_of_steps(const std::vector<TeamMember>& members, const Configurations& path, double step) {
  TeamTimes times;
  std::vector<double> arrived(members.size(), 0.0);
  for (std::size_t i = 0; i < path.size(); ++i) {
    times.at.push_back(static_cast<double>(i) * step);
    for (std::size_t r = 0; i > 0 && r < members.size(); ++r) {
      const bool moves = std::any_of(members[r].axes.begin(), members[r].axes.end(),
                                     [&](std::size_t axis) { return path[i][axis] != path[i - 1][axis]; });
      if (moves) arrived[r] = times.at[i];
    }
  }
  count_arrivals(arrived, times);
  return times;
}

}  // namespace trellis
