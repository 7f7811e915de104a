// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/pictures/traces.hpp>

#include <algorithm>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/team_times.hpp>

namespace trellis {

namespace {

/// Returns which robot of the root's team an axis moves, by its name: spaces of some robots keep the names.
std::optional<std::size_t> robot_of(const std::string& axis, const LevelRecord& root) {
  const std::vector<Axis> axes = root.space.coordinates();
  const std::vector<TeamMember> members = root.scene->members();
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (const std::size_t own : members[i].axes) {
      if (axes.at(own).name == axis) return i;
    }
  }
  return std::nullopt;
}

/// \param first  the coordinate of the level at which those of its scene's robot begin
std::vector<Trace> traces_in(const Scene& scene, const std::vector<std::size_t>& position, std::size_t first) {
  const std::vector<TeamMember> members = scene.members();
  std::vector<Trace> traces;
  if (members.size() > 1 && scene.manipulator() == nullptr) {
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (!members[i].translates) continue;
      std::vector<std::size_t> axes(scene.world_dimension());
      std::iota(axes.begin(), axes.end(), first + members[i].axes.front());
      traces.push_back({i, std::move(axes), {}});
    }
  } else if (const ManipulatorScene* manipulator = scene.manipulator(); manipulator != nullptr && position.empty()) {
    for (const PointOnBody& tip : manipulator->robot.tips()) traces.push_back({traces.size(), {}, tip});
  } else if (!position.empty()) {
    traces.push_back({0, position, {}});
  }
  return traces;
}

}  // namespace

std::vector<Trace> traces_of(const std::vector<LevelResult>& levels, std::size_t level) {
  const LevelRecord& record = levels.at(level).record;
  if (record.scene == nullptr) {
    return record.position_axes.empty() ? std::vector<Trace>() : std::vector<Trace>{{0, record.position_axes, {}}};
  }
  const bool whole = record.space.dimension() >= record.scene->robot_dimension();
  if (!whole && record.position_axes.empty()) return {};
  const std::size_t first = first_coordinate(levels, level);
  std::vector<Trace> traces = traces_in(*record.scene, record.position_axes, first);
  const LevelRecord& root = levels.front().record;
  if (level == 0 || root.scene == nullptr || root.scene->members().size() < 2) return traces;
  const std::vector<Axis> axes = record.space.coordinates();
  const std::vector<TeamMember> members = record.scene->members();
  for (Trace& trace : traces) {
    const std::size_t own = !trace.axes.empty()
                                ? trace.axes.front()
                                : first + (trace.robot < members.size() ? members[trace.robot].axes.front() : 0);
    if (const auto robot = robot_of(axes.at(own).name, root)) {
      trace.robot = *robot;
    } else if (record.parent > 0 && traces.size() == 1) {
      const auto above = traces_of(levels, static_cast<std::size_t>(record.parent));
      if (!above.empty()) trace.robot = above.front().robot;
    }
  }
  return traces;
}

std::size_t first_coordinate(const std::vector<LevelResult>& levels, std::size_t level) {
  const LevelRecord& root = levels.front().record;
  if (level == 0 || root.scene == nullptr || root.scene->members().size() < 2) return 0;
  const std::vector<Axis> axes = levels[level].record.space.coordinates();
  const auto own =
      std::find_if(axes.begin(), axes.end(), [&](const Axis& axis) { return robot_of(axis.name, root).has_value(); });
  return own == axes.end() ? 0 : static_cast<std::size_t>(own - axes.begin());
}

std::vector<Trace> traces_of(const Problem& problem) {
  if (problem.scene == nullptr) return {};
  std::vector<std::size_t> position;
  if (problem.scene->translates()) {
    position.resize(problem.scene->world_dimension());
    std::iota(position.begin(), position.end(), std::size_t{0});
  }
  return traces_in(*problem.scene, position, 0);
}

Configurations moments_of(const Scene* scene, const Space& space, const Configurations& path, std::size_t count) {
  Configurations moments(space.dimension());
  if (path.size() == 0) return moments;
  const std::vector<TeamMember> members = scene == nullptr ? std::vector<TeamMember>() : scene->members();
  std::vector<double> at = {0.0};
  if (members.size() > 1 && space.dimension() == scene->robot_dimension()) {
    at = times_of(space, members, path).at;
  } else {
    for (std::size_t i = 1; i < path.size(); ++i) at.push_back(at.back() + space.distance(path[i - 1], path[i]));
  }
  if (!(at.back() > 0.0)) count = 1;
  Configuration q(space.dimension());
  std::size_t leg = 1;
  for (std::size_t k = 0; k < count; ++k) {
    if (path.size() == 1 || count == 1) {
      moments.push(path[0]);
      continue;
    }
    const double time = at.back() * static_cast<double>(k) / static_cast<double>(count - 1);
    while (leg + 1 < path.size() && at[leg] < time) ++leg;
    const double span = at[leg] - at[leg - 1];
    space.interpolate(path[leg - 1], path[leg], span > 0.0 ? std::clamp((time - at[leg - 1]) / span, 0.0, 1.0) : 1.0,
                      q);
    moments.push(q);
  }
  return moments;
}

}  // namespace trellis
