// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/position.hpp>

#include <vector>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

const std::vector<std::size_t>& position_of(const std::string& guide, const Instance& parent) {
  if (parent.position_axes.size() == 2) return parent.position_axes;
  throw Error(guide + ": needs a robot whose reference point moves in the plane; this space (" + parent.space.name() +
              ") has no position");
}

}  // namespace

PositionProjection::PositionProjection(const std::string& guide, const Instance& parent)
    : AxisProjection(parent.space, position_of(guide, parent), "R^2") {}

std::unique_ptr<Instance> PositionProjection::point_instance(const Instance& parent) const {
  auto instance = std::make_unique<Instance>();
  instance->space = space();
  instance->scene = std::make_shared<Scene>(Scene{parent.scene->world, Robot::point()});
  instance->validity = make_validity(parent.collision, instance->scene, instance->space, parent.resolution, nullptr);
  instance->start.resize(2);
  instance->goal.resize(2);
  project(parent.start, instance->start);
  project(parent.goal, instance->goal);
  instance->goal_tolerance = parent.goal_tolerance;
  instance->resolution = parent.resolution;
  instance->collision = parent.collision;
  instance->position_axes = {0, 1};
  return instance;
}

}  // namespace trellis
