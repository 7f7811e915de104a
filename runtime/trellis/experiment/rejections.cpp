// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/rejections.hpp>

#include <algorithm>
#include <map>

#include <trellis/collision/checker.hpp>

namespace trellis {

Rejections rejections(const LevelRecord& level, double resolution, std::size_t most) {
  Rejections result;
  // The space of a projection, such as drop(), may have fewer axes than the robot: its validity is not this scene's.
  if (level.presumed || !level.scene || !level.places_robot || level.space.dimension() < level.scene->robot_dimension())
    return result;
  const Search& search = level.search;
  std::vector<std::size_t> blocked;
  for (std::size_t i = 0; i < search.fates.size(); ++i) {
    if (search.fates[i] == Fate::rejected && search.near[i] != no_node) blocked.push_back(i);
  }
  result.rejected = blocked.size();
  if (blocked.empty()) return result;
  const auto checker = make_checker(collision_backends(*level.scene).front(), level.scene, level.space, resolution);
  std::map<std::string, std::size_t> counts;
  Configuration invalid(level.space.dimension());
  const std::size_t looked = std::min(most, blocked.size());
  for (std::size_t k = 0; k < looked; ++k) {
    const std::size_t i = blocked[k * blocked.size() / looked];
    const View from = search.nodes[search.near[i]];
    const View to = search.proposals[i];
    const MotionReport report = checker->motion(from, to);
    if (report.valid) continue;
    level.space.interpolate(from, to, report.invalid_at, invalid);
    const auto contact = checker->contact(invalid);
    if (!contact) continue;
    ++result.examined;
    ++counts[describe(*contact, *level.scene)];
  }
  result.by.assign(counts.begin(), counts.end());
  std::stable_sort(result.by.begin(), result.by.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return result;
}

}  // namespace trellis
