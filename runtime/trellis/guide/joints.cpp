// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/guide/axis_projection.hpp>
#include <trellis/guide/kinds.hpp>
#include <trellis/guide/path_guide.hpp>

namespace trellis {

namespace {

struct JointsSettings : PathGuideSettings {
  std::vector<std::string> axes;
  std::int64_t first = 2;
};

const Settings<JointsSettings>& joints_settings() {
  static const Settings<JointsSettings> settings = with_resolves(with_progress(with_radius(
      Settings<JointsSettings>(
          Component::Kind::guide, "joints",
          "some of the degrees of freedom: what hangs on the others is left out of the robot; S is "
          "sampled, where the paper divides it into slices, and the others are uniform, where it "
          "computes their free ranges",
          "Lozano-Perez 1987, A simple motion-planning algorithm for general robot manipulators")
          .names("axes", &JointsSettings::axes,
                 "the axes of C that S keeps, by name (\"theta2\") or by number (\"2\"), in any order; none: the first "
                 "ones")
          .integer("first", &JointsSettings::first, "axes", Range::at_least(1),
                   "how many axes from the first on S keeps where none are named; all where C has no more")
          .positional({"axes"}))));
  return settings;
}

/// The axes that are kept, ascending. Throws Error for one that C does not have.
std::vector<std::size_t> kept_axes(const Space& space, const JointsSettings& settings) {
  const std::size_t d = space.dimension();
  if (settings.axes.empty()) {
    std::vector<std::size_t> kept(std::min<std::size_t>(d, static_cast<std::size_t>(settings.first)));
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    return kept;
  }
  std::vector<std::string> names;
  names.reserve(d);
  for (const auto& axis : space.axes()) names.push_back(axis.name);
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

/// The robot that the kept axes place: bodies whose position and angle depend on no other axis; of one whose angle
/// does, the largest disc about its origin. Its own axes are numbered as S has them.
class Reduction {
 public:
  Reduction(const Robot& robot, const std::vector<std::size_t>& axes) : robot_(robot) {
    for (std::size_t j = 0; j < axes.size(); ++j) {
      if (axes[j] < robot.dimension()) place_of_[axes[j]] = static_cast<int>(j);
    }
  }

  /// None where nothing with a shape is placed.
  std::optional<Robot> robot() {
    const bool placed = !robot_.translates() || (known(0) && known(1));
    if (!placed) return std::nullopt;
    for (const Body& body : robot_.bodies()) add(body);
    if (std::none_of(bodies_.begin(), bodies_.end(), [](const Body& body) { return !body.parts.empty(); })) {
      return std::nullopt;
    }
    add_idle_axes();
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (const auto& [first, second] : robot_.pairs()) {
      if (places_[first] >= 0 && places_[second] >= 0) {
        pairs.emplace_back(static_cast<std::size_t>(places_[first]), static_cast<std::size_t>(places_[second]));
      }
    }
    return Robot(robot_.name(), std::move(bodies_), robot_.translates(), robot_.base()).apart(std::move(pairs));
  }

 private:
  [[nodiscard]] bool known(int axis) const { return place_of_.contains(static_cast<std::size_t>(axis)); }

  void add(const Body& body) {
    const bool rooted = body.parent < 0;
    const auto parent = static_cast<std::size_t>(rooted ? 0 : body.parent);
    const bool origin = rooted || (places_[parent] >= 0 && (turns_known_[parent] || body.joint == Vec2{}));
    const bool own = body.angle_axis < 0 || known(body.angle_axis);
    const bool turn = own && (rooted || turns_known_[parent] || (body.absolute && body.angle_axis >= 0));
    const double radius = origin && !turn ? inscribed(body) : 0.0;
    turns_known_.push_back(origin && turn);
    if (!origin || (!turn && !(radius > 0.0))) {
      places_.push_back(-1);
      return;
    }
    places_.push_back(static_cast<int>(bodies_.size()));
    Body kept = body;
    if (!rooted) kept.parent = places_[parent];
    if (!turn) {
      kept.parts = {Disc{{}, radius}};
      kept.angle_axis = -1;
    } else if (kept.angle_axis >= 0) {
      kept.angle_axis = place_of_.at(static_cast<std::size_t>(body.angle_axis));
    }
    bodies_.push_back(std::move(kept));
  }

  /// The radius of the largest disc about the body's origin inside it.
  static double inscribed(const Body& body) {
    if (body.parts.empty()) return 0.0;
    Body alone;
    alone.parts = body.parts;
    return Robot("body", {std::move(alone)}).inscribed_radius();
  }

  /// A kept axis that turns nothing that is left: a robot wants every one of its axes to turn a body.
  void add_idle_axes() {
    const int first_angle = robot_.translates() ? 2 : 0;
    int last = -1;
    for (const Body& body : bodies_) last = std::max(last, body.angle_axis);
    for (int axis = first_angle; axis < last; ++axis) {
      if (std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.angle_axis == axis; })) continue;
      Body idle;
      idle.angle_axis = axis;
      bodies_.push_back(std::move(idle));
    }
  }

  const Robot& robot_;
  std::map<std::size_t, int> place_of_;  ///< of a robot's axis that is kept, in S
  std::vector<Body> bodies_;
  std::vector<int> places_;        ///< of each body of the robot among those that are kept; -1: it is not
  std::vector<bool> turns_known_;  ///< of each body whether position and angle are known
};

/// h along a path in S: a tube about it, with uniform values of the axes that were dropped.
class JointsHeuristic final : public ProjectedHeuristic {
 public:
  JointsHeuristic(const std::shared_ptr<const AxisProjection>& projection, std::unique_ptr<PathHeuristic> below,
                  const Instance& parent)
      : ProjectedHeuristic(projection, projection->space().dimension(), parent.start, parent.goal),
        below_(std::move(below)) {}

  [[nodiscard]] double density(View q) const override {
    return LiftedDensity(projection(), dimension(), below_->tube_density()).at(q);
  }
  void record(DensityRecord& record, double share) const override {
    record.add(std::make_shared<LiftedDensity>(projection(), dimension(), below_->tube_density()), share);
  }

 protected:
  [[nodiscard]] Heuristic& inner() const override { return *below_; }

 private:
  std::unique_ptr<PathHeuristic> below_;
};

class Joints final : public Guide {
 public:
  explicit Joints(JointsSettings settings) : settings_(std::move(settings)) {}

  std::unique_ptr<Instance> project(const Instance& parent) override {
    if (parent.validity_of || parent.scene->robot.dimension() > parent.space.dimension()) {
      throw Error(fmt::format(
          "joints: needs a space whose axes are the robot's; those of {} are not, so keep some of the joints below it",
          parent.space.name()));
    }
    const auto axes = kept_axes(parent.space, settings_);
    std::vector<std::string> names;
    names.reserve(axes.size());
    for (const std::size_t axis : axes) names.push_back(parent.space.axes()[axis].name);
    const std::string kept = fmt::format("{}", fmt::join(names, ", "));
    projection_ =
        std::make_shared<AxisProjection>(parent.space, axes, fmt::format("{} of {}", kept, parent.space.name()));
    auto robot = Reduction(parent.scene->robot, axes).robot();
    if (!robot) {
      throw Error(
          fmt::format("joints: nothing of the robot '{}' is placed by {} alone, so that everything would be valid in "
                      "S; keep {} too",
                      parent.scene->robot.name(), kept,
                      parent.scene->robot.translates() ? "x and y" : "the axes of the joints nearer to the base"));
    }
    auto instance = std::make_unique<Instance>();
    instance->space = projection_->space();
    instance->scene = std::make_shared<Scene>(Scene{parent.scene->world, std::move(*robot)});
    instance->validity = make_validity(parent.collision, instance->scene, instance->space, parent.resolution, nullptr);
    instance->start.resize(axes.size());
    instance->goal.resize(axes.size());
    projection_->project(parent.start, instance->start);
    projection_->project(parent.goal, instance->goal);
    instance->goal_tolerance = parent.goal_tolerance;
    instance->resolution = parent.resolution;
    instance->collision = parent.collision;
    for (const std::size_t axis : parent.position_axes) {
      const auto place = std::find(axes.begin(), axes.end(), axis);
      if (place != axes.end()) instance->position_axes.push_back(static_cast<std::size_t>(place - axes.begin()));
    }
    if (instance->position_axes.size() != parent.position_axes.size()) instance->position_axes.clear();
    start_ = instance->start;
    restart();
    added_.resize(axes.size());
    return instance;
  }

  void project(View q, MutableView s) const override { projection_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { projection_->lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View) const override { return -projection_->log_fibre_volume(); }

  void learn(const Outcome& outcome) override {
    if (outcome.added.empty() || !outcome.connected) return;
    projection_->project(outcome.added, added_);
    reached_->add(added_);
  }
  void restart() override {
    reached_.emplace(projection_->space());
    reached_->add(start_);
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    if (found->path.size() < 2) return std::make_unique<UniformHeuristic>("joints (found nothing)", parent.space);
    const double step = parent.step > 0.0 ? parent.step : natural_distance(*sub);
    const double window = settings_.window > 0.0 ? settings_.window : 2.0 * step;
    auto below = std::make_unique<PathHeuristic>("joints", sub->space, found->path, tube_radius(settings_, *sub),
                                                 window, settings_.evidence, &*reached_);
    return std::make_unique<JointsHeuristic>(projection_, std::move(below), parent);
  }

 private:
  JointsSettings settings_;
  std::shared_ptr<const AxisProjection> projection_;
  std::optional<NearestIndex> reached_;  ///< by the planner's nodes, in S
  Configuration start_;                  ///< in S
  Configuration added_;
};

}  // namespace

GuideKind joints_kind() {
  GuideClaims claims = path_claims(
      GuideClaims::Category::robot,
      "q -> its coordinates on the axes kept; of the robot what they place, and of a body that an axis dropped turns "
      "the "
      "largest disc about its origin",
      "S has no path; no end that is valid in C becomes invalid, as S checks no more than a part of the robot",
      "examples/two_joint_arm.lua");
  claims.h =
      "a point of the path found in S, from the stretch just beyond what the tree has reached, then uniform on a ball "
      "about it in S; the axes dropped are uniform";
  claims.needs = GuideClaims::Needs::robot_axes;
  claims.density = "of the tube in S, over the volume of the axes dropped";
  return {
      &joints_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Joints>(joints_settings().read(o)); },
      "rrt", [](const Options& o) { return joints_settings().read(o).resolves; }, std::move(claims)};
}

}  // namespace trellis
