// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/guide/axis_projection.hpp>
#include <trellis/guide/goal_choice.hpp>
#include <trellis/guide/joint_ranges.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/team.hpp>
#include <trellis/instance/characteristic_length.hpp>

namespace trellis {

namespace {

struct JointsSettings : PathGuideSettings {
  std::vector<std::string> axes;
  std::int64_t first = 2;
  std::int64_t slices = 0;
};

const Settings<JointsSettings>& joints_settings() {
  static const Settings<JointsSettings> settings = with_resolves(with_progress(with_radius(
      Settings<JointsSettings>(
          Component::Kind::guide, "joints",
          "some of the degrees of freedom: what the others move is left out of the robot; the others are drawn "
          "uniformly, or, as published, from their free ranges (`slices`). S is sampled, where the paper searches the "
          "union of its slices",
          "Lozano-Perez 1987, A simple motion-planning algorithm for general robot manipulators")
          .names("axes", &JointsSettings::axes,
                 "the axes of C that S keeps, by name (\"theta2\") or by number (\"2\"), in any order; none: the first "
                 "ones")
          .integer(
              "first", &JointsSettings::first, "axes", Range::at_least(1),
              "how many axes from the first on S keeps where none are named, in space at least x, y and z; all where C "
              "has no more")
          .integer("slices", &JointsSettings::slices, "slices of an axis", {.lo = 0, .hi = 1024},
                   "each axis is divided into so many: the axes left out are drawn from the slices in which what is "
                   "placed so far is valid, given the slices of the axes before, with a share of 0.1 uniform; and a "
                   "slice of S without a free one of the next axis is invalid. A slice is checked at its middle, once; "
                   "the level that asks for it pays. 0: the axes left out are uniform")
          .positional({"axes"}))));
  return settings;
}

/// The kept axes, ascending.
/// \throws Error for an axis that C lacks
std::vector<std::size_t> kept_axes(const Space& space, const JointsSettings& settings) {
  const std::size_t d = space.dimension();
  if (settings.axes.empty()) {
    // The position in space takes three.
    const std::size_t first = std::max<std::size_t>(static_cast<std::size_t>(settings.first), space.flat() ? 1 : 3);
    std::vector<std::size_t> kept(std::min(d, first));
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    return kept;
  }
  std::vector<std::string> names;
  names.reserve(d);
  for (const auto& axis : space.coordinates()) names.push_back(axis.name);
  std::set<std::size_t> kept;
  for (const std::string& asked : settings.axes) {
    const auto named = std::find(names.begin(), names.end(), asked);
    std::size_t axis = static_cast<std::size_t>(named - names.begin());
    if (named == names.end()) {
      const auto [end, fault] = std::from_chars(asked.data(), asked.data() + asked.size(), axis);
      if (fault != std::errc() || end != asked.data() + asked.size() || axis < 1 || axis > d) {
        throw Error(fmt::format("joints: no axis '{}' in {}, which has {} (1 to {}){}", asked, space.name(),
                                fmt::join(names, ", "), d, did_you_mean(asked, names)));
      }
      --axis;
    }
    if (!kept.insert(axis).second) {
      throw Error(fmt::format("joints: the axis {} is there twice", names[axis]));
    }
  }
  return {kept.begin(), kept.end()};
}

struct TeamSettings : PathGuideSettings {
  std::vector<std::string> robots = {"1"};
};

const Settings<TeamSettings>& team_settings() {
  static const Settings<TeamSettings> settings = with_resolves(with_progress(
      with_radius(Settings<TeamSettings>(Component::Kind::guide, "team",
                                         "some robots of a team, as if the others were not there; the others are drawn "
                                         "uniformly",
                                         "Orthey, Escande and Yoshida 2018, Quotient-space motion planning")
                      .names("robots", &TeamSettings::robots, "the numbers of the robots that S keeps, from 1 on")
                      .positional({"robots"}))));
  return settings;
}

/// Some of the axes of C: of a robot, or those of some robots of a team.
class Joints final : public Guide {
 public:
  explicit Joints(JointsSettings settings) : settings_(std::move(settings)) {}
  explicit Joints(const TeamSettings& settings) : name_("team"), robots_(settings.robots) {
    static_cast<PathGuideSettings&>(settings_) = settings;
  }

  std::unique_ptr<Instance> project(const Instance& parent) override {
    if (parent.validity_of || parent.scene->robot_dimension() > parent.space.dimension()) {
      throw Error(
          fmt::format("{0}: needs a space whose axes are the robot's; those of {1} are not, so use {0} below it", name_,
                      parent.space.name()));
    }
    if (!robots_.empty() && parent.scene->members().size() < 2) {
      throw Error(
          fmt::format("team: needs a team, as robots {{ robot.disc(0.3), robot.disc(0.3) }}, and robot '{}' is one",
                      parent.scene->robot_name()));
    }
    const auto axes = robots_.empty()
                          ? kept_axes(parent.space, settings_)
                          : axes_of(parent.scene->members(), members_named(name_, robots_, parent.scene->members()));
    std::vector<std::string> names;
    names.reserve(axes.size());
    const std::vector<Axis> coordinates = parent.space.coordinates();
    for (const std::size_t axis : axes) names.push_back(coordinates[axis].name);
    const std::string kept = fmt::format("{}", fmt::join(names, ", "));
    projection_ =
        std::make_shared<AxisProjection>(parent.space, axes, fmt::format("{} of {}", kept, parent.space.name()));
    const auto scene = parent.scene->reduced(axes);
    if (!scene) {
      throw Error(
          fmt::format("joints: nothing of the robot '{}' is placed by {} alone, so that everything would be valid in "
                      "S; keep {} too",
                      parent.scene->robot_name(), kept,
                      parent.scene->translates() ? parent.scene->world_dimension() == 2 ? "x and y" : "x, y and z"
                                                 : "the axes of the joints nearer to the base"));
    }
    auto instance = std::make_unique<Instance>();
    instance->space = projection_->space();
    instance->scene = scene;
    instance->validity = make_validity(parent.collision, instance->scene, instance->space, parent.resolution, nullptr);
    ranges_ = nullptr;
    ranged_ = nullptr;
    ranged_lift_ = nullptr;
    lifting_ = projection_;
    if (settings_.slices > 0 && !parent.space.flat()) {
      throw Error(fmt::format("joints: slices divide axes, and {} has a rotation, which has none; leave out 'slices'",
                              parent.space.name()));
    }
    if (settings_.slices > 0 && axes.size() < parent.space.dimension()) {
      ranges_ = std::make_shared<JointRanges>(parent, projection_, static_cast<std::size_t>(settings_.slices));
      // Start and goals are valid even if the middles of their slices are not.
      ranges_->declare_free(parent.start);
      for (const auto& goal : parent.goals) ranges_->declare_free(goal);
      lifting_ = ranged_lift_ = std::make_shared<RangedProjection>(ranges_);
      ranged_ = std::make_shared<RangedValidity>(instance->validity, ranges_);
      instance->validity = ranged_;
    }
    project_ends(*projection_, parent, *instance);
    instance->goal_tolerance = parent.goal_tolerance;
    instance->resolution = parent.resolution;
    instance->collision = parent.collision;
    for (const std::size_t axis : parent.position_axes) {
      const auto place = std::find(axes.begin(), axes.end(), axis);
      if (place != axes.end()) instance->position_axes.push_back(static_cast<std::size_t>(place - axes.begin()));
    }
    if (instance->position_axes.size() != parent.position_axes.size()) instance->position_axes.clear();
    if (scene->translates() && !parent.scene->translates()) {
      instance->position_axes.resize(scene->world_dimension());
      std::iota(instance->position_axes.begin(), instance->position_axes.end(), std::size_t{0});
    }
    reached_.emplace(projection_->space(), instance->start);
    added_.resize(axes.size());
    return instance;
  }

  void attach(Instance& sub) override {
    if (ranged_) ranged_->count_in(sub);
  }
  void project(View q, MutableView s) const override { projection_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { projection_->lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View) const override { return -projection_->log_fibre_volume(); }

  void learn(const Outcome& outcome) override {
    if (outcome.added.empty() || !outcome.connected) return;
    projection_->project(outcome.added, added_);
    reached_->add(added_);
  }
  void restart() override { reached_->clear(); }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    if (found->path.size() < 2) return std::make_unique<UniformHeuristic>(name_ + " (found nothing)", parent.space);
    if (ranged_lift_) ranged_lift_->count_in(parent);
    const double step = parent.step > 0.0 ? parent.step : characteristic_length(*sub);
    const double window = settings_.window > 0.0 ? settings_.window : 2.0 * step;
    auto below = std::make_unique<PathHeuristic>(name_, sub->space, found->path, tube_radius(settings_, *sub), window,
                                                 settings_.evidence, &*reached_);
    const Configuration& goal = goal_choice_.choose(
        parent, [this](View q, MutableView s) { project(q, s); }, sub->space, found->path);
    return std::make_unique<LiftedHeuristic>(lifting_, sub->space, std::move(below), parent.start, goal,
                                             LiftedHeuristic::Points::atoms);
  }

 private:
  JointsSettings settings_;
  std::string name_ = "joints";
  std::vector<std::string> robots_;  ///< of a team; empty: axes are kept
  std::shared_ptr<const AxisProjection> projection_;
  std::shared_ptr<const Projection> lifting_;      ///< lift of the samples of h
  std::shared_ptr<JointRanges> ranges_;            ///< set if the option requests them
  std::shared_ptr<RangedProjection> ranged_lift_;  ///< `lifting_`, if there are ranges
  std::shared_ptr<RangedValidity> ranged_;         ///< of S, if there are ranges
  std::optional<ReachedIndex> reached_;            ///< the planner's nodes, in S
  GoalChoice goal_choice_;
  Configuration added_;
};

}  // namespace

GuideKind team_kind() {
  GuideClaims claims =
      path_claims(GuideClaims::Category::robot, "q -> the coordinates of the robots kept",
                  "S has no path; a start or goal that is valid in C stays valid, because S checks fewer robots",
                  "examples/many_robots.lua");
  claims.h =
      "a point of the path found in S, from the stretch just beyond what the tree has reached, then uniform on a ball "
      "about it in S; the other robots are uniform";
  claims.needs = GuideClaims::Needs::team;
  claims.density = "of the tube in S times that of the other robots";
  return GuideKind{
      &team_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Joints>(team_settings().read(o)); },
      "rrt_connect", [](const Options& o) { return team_settings().read(o).resolves; }, std::move(claims)}
      .set_up({.run = {75, 0.125}}, {.run = {800}});
}

GuideKind joints_kind() {
  GuideClaims claims = path_claims(
      GuideClaims::Category::robot,
      "q -> its coordinates on the axes kept; of the robot what they place, and of a body that an axis dropped turns "
      "the "
      "largest disc about its origin",
      "S has no path; a start or goal that is valid in C stays valid, because S checks only a part of the robot",
      "examples/two_joint_arm.lua");
  claims.h =
      "a point of the path found in S, from the stretch just beyond what the tree has reached, then uniform on a ball "
      "about it in S; the axes dropped are uniform, or from their free ranges";
  claims.needs = GuideClaims::Needs::robot_axes;
  claims.density = "of the tube in S times that of the axes dropped";
  return GuideKind{
      &joints_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Joints>(joints_settings().read(o)); },
      "rrt", [](const Options& o) { return joints_settings().read(o).resolves; }, std::move(claims)}
      .set_up({.run = {110, 0.125}}, {.run = {700}});
}

}  // namespace trellis
