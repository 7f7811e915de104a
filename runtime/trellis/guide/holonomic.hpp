// SPDX-License-Identifier: GPL-3.0-or-later
// The robot without its motion model, as a guiding space.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/axis_projection.hpp>
#include <trellis/guide/goal_choice.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/plane.hpp>

namespace trellis {

struct HolonomicSettings : PathGuideSettings {
  HolonomicSettings() { follow = Follow::tube; }
  bool heading_found = false;
  bool any_speed = false;
};

/// The options of guides whose S is the robot without its motion model.
template <class S>
Settings<S> with_holonomic_options(Settings<S> settings) {
  return with_several_paths(with_path_options(
      std::move(settings)
          .choice("heading", &S::heading_found, {{"along", false}, {"found", true}},
                  "the robot's heading on the path that is followed: \"along\", in the direction of travel, which is "
                  "how a wheeled robot can follow it; \"found\", as the search in S had it")
          .choice(
              "speed", &S::any_speed, {{"forwards", false}, {"any", true}},
              "which speeds are drawn where they are part of the state: \"forwards\", those not below 0 where there "
              "are any; \"any\", all; other velocities are drawn from all there are")));
}

/// f forgets the motion model: configurations without velocities, joined by straight motions. h is a tube about the
/// path found, lifted.
class Holonomic : public PathGuide {
 public:
  /// \param name  of the guide in the language
  Holonomic(const std::string& name, const HolonomicSettings& settings)
      : PathGuide(name, settings), name_(name), along_(!settings.heading_found), forwards_(!settings.any_speed) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    require_plane(name_.c_str(), parent);
    const std::size_t kept =
        parent.motion_model ? parent.motion_model->configuration_dimension() : parent.space.dimension();
    std::vector<std::size_t> axes(kept);
    std::iota(axes.begin(), axes.end(), std::size_t{0});
    std::string name = parent.space.name();
    if (kept < parent.space.dimension()) name.resize(name.rfind(" x "));
    projection_ = std::make_shared<AxisProjection>(parent.space, axes, name);
    std::vector<Axis> drawn = parent.space.axes();
    for (std::size_t j = kept; j < drawn.size(); ++j) {
      // Of a team they are v, v2, v3, ...
      const std::string& axis = drawn[j].name;
      const bool speed = axis.front() == 'v' && axis.find_first_not_of("0123456789", 1) == std::string::npos;
      if (forwards_ && speed && drawn[j].hi > 0.0) drawn[j].lo = std::max(drawn[j].lo, 0.0);
    }
    drawn_ = std::make_shared<AxisProjection>(Space(parent.space.name(), std::move(drawn)), axes, name);
    auto instance = same_instance(parent);
    instance->space = projection_->space();
    instance->motion_model = nullptr;
    instance->start.resize(kept);
    for (Configuration& goal : instance->goals) goal.resize(kept);
    sort_goals(*instance);
    // S ignores the limits of the motion model. A presumption of C applies to its states, not to this space, so S makes
    // its own checks.
    if (parent.motion_model) {
      // Where robots of a team follow paths, S ignores these too.
      instance->validity = parent.validity_of ? parent.validity_of(parent.scene)
                                              : make_validity(parent.collision, parent.scene, instance->space,
                                                              parent.resolution, nullptr);
    }
    turns_ = along_ && parent.motion_model != nullptr;
    headed_.clear();
    for (const TeamMember& member : parent.scene->members()) headed_.push_back(member.axes);
    if (headed_.empty()) {
      const std::size_t first = parent.position_axes.empty() ? 0 : parent.position_axes.front();
      headed_.emplace_back(axes.begin() + static_cast<std::ptrdiff_t>(first), axes.end());
    }
    return instance;
  }
  void attach(Instance& sub) override {
    PathGuide::attach(sub);
    sub_ = &sub;
  }

  void project(View q, MutableView s) const override { projection_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { projection_->lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View) const override { return -projection_->log_fibre_volume(); }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    if (found->path.size() < 2) {
      static_cast<void>(PathGuide::heuristic(*sub_, sub, found));
      return std::make_unique<UniformHeuristic>(name_ + " (found nothing)", parent.space);
    }
    const Configuration& goal = goal_choice_.choose(
        parent, [this](View q, MutableView s) { project(q, s); }, projection_->space(), found->path);
    // Velocities are drawn from the fibre.
    return std::make_unique<LiftedHeuristic>(drawn_, drawn_->space(), PathGuide::heuristic(*sub_, sub, found),
                                             parent.start, goal, LiftedHeuristic::Points::atoms);
  }

  void learn(const Outcome& outcome) override {
    if (outcome.added.empty()) return;
    Configuration s(projection_->space().dimension());
    projection_->project(outcome.added, s);
    Outcome below;
    below.added = s;
    below.connected = outcome.connected;
    below.from_goal = outcome.from_goal;
    PathGuide::learn(below);
  }

 protected:
  [[nodiscard]] const Instance& followed_in(const Instance&, const Instance& sub) const override { return sub; }
  /// S lacks only velocity limits: its paths are free of collision in C too, so blocked proposals do not refute them.
  [[nodiscard]] bool relaxes() const override { return false; }
  /// f.
  [[nodiscard]] std::shared_ptr<const AxisProjection> projection() const { return projection_; }
  /// Rotates the path into the direction of travel: on each edge, all bodies have the heading of its direction, of a
  /// team each robot that moves there its own; start and goal keep theirs.
  Configurations followed(Configurations path) const override {
    if (!turns_ || path.size() < 2) return path;
    Configurations turned(path.dimension());
    turned.push(std::as_const(path).front());
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      Configuration a(path[i].begin(), path[i].end());
      Configuration b(path[i + 1].begin(), path[i + 1].end());
      bool moves = false;
      for (const std::vector<std::size_t>& robot : headed_) {
        const double dx = b[robot[0]] - a[robot[0]];
        const double dy = b[robot[1]] - a[robot[1]];
        if (dx == 0.0 && dy == 0.0) continue;
        moves = true;
        for (std::size_t j = 2; j < robot.size(); ++j) a[robot[j]] = b[robot[j]] = std::atan2(dy, dx);
      }
      if (!moves) continue;
      projection_->space().normalise(a);
      projection_->space().normalise(b);
      turned.push(a);
      turned.push(b);
    }
    turned.push(std::as_const(path).back());
    return turned;
  }

 private:
  std::string name_;
  bool along_;
  bool forwards_;
  /// The coordinates of each robot that has a heading: of a robot alone all.
  std::vector<std::vector<std::size_t>> headed_;
  bool turns_ = false;  ///< there is a motion model, and its robot has a heading
  std::shared_ptr<const AxisProjection> projection_;
  std::shared_ptr<const AxisProjection> drawn_;  ///< over the part of C that h samples
  Instance* sub_ = nullptr;                      ///< owned by the level
  GoalChoice goal_choice_;
};

}  // namespace trellis
