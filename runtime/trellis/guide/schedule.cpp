// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/schedule.hpp>

#include <algorithm>
#include <cstdint>
#include <queue>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

namespace trellis {

std::optional<Configurations> schedule(Instance& paths, std::size_t cells, std::size_t most) {
  const std::size_t groups = paths.space.dimension();
  /// How many cells each group has moved.
  using Place = std::string;
  const auto at = [&](const Place& place) {
    Configuration s(groups);
    for (std::size_t g = 0; g < groups; ++g) {
      const double share = static_cast<double>(place[g]) / static_cast<double>(cells);
      s[g] = paths.start[g] + share * (paths.goal()[g] - paths.start[g]);
    }
    return s;
  };
  const Place start(groups, '\0'), goal(groups, static_cast<char>(cells));
  std::unordered_map<Place, Place> reached_from = {{start, start}};
  // The fewest cells left first; of equal ones the one found last, so that the search goes on where it is.
  using Entry = std::tuple<std::size_t, std::size_t, Place>;
  const auto later = [](const Entry& a, const Entry& b) {
    return std::pair(std::get<0>(a), ~std::get<1>(a)) > std::pair(std::get<0>(b), ~std::get<1>(b));
  };
  std::priority_queue<Entry, std::vector<Entry>, decltype(later)> open(later);
  std::size_t number = 0;
  open.emplace(groups * cells, number, start);
  for (std::size_t expanded = 0; expanded < most && !open.empty(); ++expanded) {
    const Place here = std::get<2>(open.top());
    open.pop();
    const Configuration from = at(here);
    const auto reach = [&](const Place& next) {
      if (next == here || reached_from.contains(next) || !paths.motion(from, at(next)).valid) return;
      reached_from.emplace(next, here);
      std::size_t left = 0;
      for (const char moved : next) left += cells - static_cast<std::size_t>(moved);
      open.emplace(left, ++number, next);
    };
    Place all = here;
    for (char& moved : all)
      moved = static_cast<char>(std::min<std::size_t>(cells, static_cast<std::size_t>(moved) + 1));
    reach(all);
    for (std::size_t g = 0; g < groups; ++g) {
      Place one = here;
      if (here[g] > 0) {
        --one[g];
        reach(one);
      }
      one[g] = std::min(static_cast<char>(cells), static_cast<char>(here[g] + 1));
      reach(one);
    }
    if (!reached_from.contains(goal)) continue;
    std::vector<Place> places = {goal};
    while (places.back() != start) places.push_back(reached_from.at(places.back()));
    Configurations path(groups);
    for (std::size_t i = places.size(); i-- > 0;) path.push(at(places[i]));
    return path;
  }
  return std::nullopt;
}

}  // namespace trellis
