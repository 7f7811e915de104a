// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/guide/goal_choice.hpp>
#include <trellis/guide/handles.hpp>
#include <trellis/guide/kinds.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/position.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/instance/grid_graph.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

/// What completes a position (option `lift`).
enum class Lift : std::uint8_t { automatic, uniform, handles, path };

struct WorkspaceSettings {
  double cell = 0.0;
  double radius = 0.0;
  Lift lift = Lift::automatic;
  std::vector<std::string> handles;
  double window = 0.0;
  std::int64_t evidence = 60;
  std::int64_t resolves = 1000;
};

const Settings<WorkspaceSettings>& workspace_settings() {
  static const Settings<WorkspaceSettings> settings =
      Settings<WorkspaceSettings>(
          Component::Kind::guide, "workspace",
          "the robot as a free point: the shortest path of its reference point among the obstacles, on a grid or by "
          "the "
          "planner given",
          "Holleman and Kavraki 2000, A framework for using the workspace medial axis in PRM planners; Denny, "
          "Sandstrom, Bregger and Amato 2016")
          .number("cell", &WorkspaceSettings::cell, "m", Range::non_negative(),
                  "side of a cell of the grid, whose edges run along sides and diagonals; 0: a fortieth, in space a "
                  "twentieth, of the longest "
                  "side of the space. Without effect where a planner is given that searches no graph")
          .number(
              "radius", &WorkspaceSettings::radius, "m in the metric", Range::non_negative(),
              "radius of the tube about the path that positions are drawn from; 0: the robot's bounding radius, or 1 % "
              "of the space's diameter for a point; with `lift = \"path\"` or \"handles\", of the balls in C that "
              "proposals are drawn from; 0: half the robot's bounding radius, or of C's diameter 1 % for a point and 5 "
              "% for an arm")
          .choice(
              "lift", &WorkspaceSettings::lift,
              {{"auto", Lift::automatic}, {"uniform", Lift::uniform}, {"handles", Lift::handles}, {"path", Lift::path}},
              "what a position is completed with: \"uniform\", uniform angles (of an arm that is fixed to its base, "
              "any that bring its tip there); \"handles\", as \"path\", but the whole robot is moved and turned "
              "until its handle points come no nearer to the medial axis of the workspace; of a robot with a motion "
              "model the path is moved to the axis and only the angles are drawn, the likelier the nearer its "
              "handles come to the axis, and other coordinates are uniform; \"path\", as skeleton does: points of "
              "the path are validated in C with angles that follow those before, and proposals are a step of the "
              "planner ahead of the node that came farthest; \"auto\", \"path\" for an arm that is fixed to its base "
              "and \"uniform\" for any other robot")
          .names("handles", &WorkspaceSettings::handles,
                 "with `lift = \"handles\"`, points of the robot: \"x, y\" in the frame of its first body, or \"n: x, "
                 "y\" in that of its n-th; a body that turns and has none gets both ends of its longest direction")
          .number("window", &WorkspaceSettings::window, "m in the metric", Range::non_negative(),
                  "how far beyond what the planner has reached proposals are drawn; 0: two of the planner's steps, or "
                  "two bounding radii where it has none")
          .integer("evidence", &WorkspaceSettings::evidence, "proposals", Range::at_least(1),
                   "guided proposals at one place of the path that C found blocked, after which the path is refuted")
          .integer("resolves", &WorkspaceSettings::resolves, "re-solves", Range::non_negative(),
                   "how often its space may be solved again")
          .positional({"cell"});
  return settings;
}

/// Factor on the cost of edges along the part of a path on which the planner made no progress.
constexpr double stuck_penalty = 2.0;
/// Factor on the cost of edges near a refuted place of the path.
constexpr double refuted_penalty = 1000.0;
/// Limit of the number of cells along one side; more indicate a mistake in the script.
constexpr double most_cells = 2000;
constexpr double most_cells_in_space = 150;

/// Makes the grid graph of the instance in S.
/// \throws Error if `cell` gives too many cells
std::shared_ptr<Graph> grid(const Instance& instance, double cell) {
  for (const auto& axis : instance.space.axes()) {
    const double count = std::ceil((axis.hi - axis.lo) / cell);
    const double most = instance.space.dimension() == 2 ? most_cells : most_cells_in_space;
    if (count > most) {
      throw Error(
          fmt::format("workspace: option 'cell' is {:g}, which makes {:g} cells along {}; expected at most {:g}", cell,
                      count, axis.name, most));
    }
  }
  return std::make_shared<Graph>(grid_graph(instance, cell));
}

class Workspace final : public Guide {
 public:
  explicit Workspace(const WorkspaceSettings& settings) : settings_(settings) {}

  std::unique_ptr<Instance> project(const Instance& parent) override {
    projection_ = std::make_shared<PositionProjection>("workspace", parent);
    const bool arm = projection_->arm();
    if (arm && settings_.lift == Lift::handles) {
      throw Error(
          "workspace: option 'lift' is \"handles\", which needs a robot whose reference point moves in the plane: the "
          "angles of an arm that is fixed to its base decide where its tip is");
    }
    const bool by_handles = settings_.lift == Lift::handles;
    if (by_handles && parent.scene->planar() == nullptr) {
      throw Error("workspace: option 'lift' is \"handles\", which works in the plane, and this scene is in space");
    }
    if (!settings_.handles.empty() && !by_handles) {
      throw Error("workspace: option 'handles' has points, which are of use with lift = \"handles\" only");
    }
    along_path_ = !parent.motion_model &&
                  (by_handles || settings_.lift == Lift::path || (arm && settings_.lift == Lift::automatic));
    auto instance = projection_->point_instance(parent);
    double longest = 0.0;
    for (const Axis& axis : instance->space.axes()) longest = std::max(longest, axis.hi - axis.lo);
    const double cells = instance->space.dimension() == 2 ? 40.0 : 20.0;
    cell_ = settings_.cell > 0.0 ? settings_.cell : longest / cells;
    graph_ = grid(*instance, cell_);
    instance->graph = graph_;
    reached_.emplace(projection_->space(), instance->start);
    refuted_ = Configurations(projection_->space().dimension());
    if (along_path_) {
      if (!nodes_.begun()) nodes_.begin(parent.space, parent.start, parent.goals);
      spacing_ = projection_->spacing(parent, *instance);
      sparse_.emplace(projection_->space(), spacing_, arm);
    }
    if (by_handles) {
      handles_ = std::make_shared<HandleLift>(
          projection_, parent, parse_handles("workspace", settings_.handles, planar(*parent.scene).robot));
    }
    return instance;
  }
  void attach(Instance& sub) override { point_ = &sub; }

  void project(View q, MutableView s) const override { projection_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { projection_->lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View q) const override { return projection_->log_fibre_density(q); }
  [[nodiscard]] bool closed_fibre() const override { return projection_->closed_fibre(); }

  void learn(const Outcome& outcome) override {
    if (outcome.added.empty() || !outcome.connected) return;
    if (along_path_) nodes_.add(outcome.added, outcome.from_goal);
    Configuration position(projection_->space().dimension());
    projection_->project(outcome.added, position);
    reached_->add(position);
  }
  void restart() override {
    reached_->clear();
    nodes_.clear();
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution* found) override {
    path_ = found->path;
    steps_ = nullptr;
    if (path_.size() < 2) return std::make_unique<UniformHeuristic>("workspace (found nothing)", parent.space);
    const Configuration& goal = goal_choice_.choose(
        parent, [this](View q, MutableView s) { project(q, s); }, projection_->space(), path_);
    if (along_path_ && found->solved()) return along(parent, goal);
    const double plain = projection_->arm() ? 0.01 * projection_->space().diameter()
                                            : size_or(*parent.scene, 0.01 * parent.space.diameter());
    radius_ = settings_.radius > 0.0 ? settings_.radius : plain;
    const double window = settings_.window > 0.0 ? settings_.window : 2.0 * step_length(parent);
    auto positions = std::make_unique<PathHeuristic>("workspace", projection_->space(),
                                                     handles_ ? handles_->on_axis(path_, *point_) : path_, radius_,
                                                     window, settings_.evidence, &*reached_);
    const std::shared_ptr<const Projection> lift = handles_ ? std::shared_ptr<const Projection>(handles_) : projection_;
    return std::make_unique<LiftedHeuristic>(lift, projection_->space(), std::move(positions), parent.start, goal,
                                             LiftedHeuristic::Points::atoms);
  }

  /// Increases the cost of edges near the refuted place, or along the part of the path that the planner did not reach.
  void before_resolve() override {
    const Space& space = projection_->space();
    NearestIndex stuck(space);
    double penalty = stuck_penalty;
    if (steps_ != nullptr) {
      goal_choice_.refute();
      if (steps_->refuted_place()) {
        if (projection_->arm() && ++variation_ <= PositionProjection::most_variations) {
          // The tip has many configurations along the path: other ones may be valid.
          sparse_.emplace(space, spacing_, true);
          return;
        }
        variation_ = 0;
        Configuration place(projection_->space().dimension());
        projection_->project(*steps_->refuted_place(), place);
        refuted_.push(place);
      }
      penalty = refuted_penalty;
      if (refuted_.size() > 0) stuck.add(std::as_const(refuted_).back());
    } else {
      for (std::size_t i = 0; i < path_.size(); ++i) {
        const View point = std::as_const(path_)[i];
        if (reached_->squared_distance(point) > radius_ * radius_) stuck.add(point);
      }
    }
    if (stuck.size() == 0) return;
    Configuration middle(projection_->space().dimension());
    for (std::size_t e = 0; e < graph_->edges.size(); ++e) {
      const auto& edge = graph_->edges[e];
      space.interpolate(graph_->vertices[edge.from], graph_->vertices[edge.to], 0.5, middle);
      if (stuck.nearest(middle).squared_distance <= cell_ * cell_) graph_->multiply_cost(e, penalty);
    }
  }

 private:
  /// h along the path found, lifted to valid configurations of C.
  std::unique_ptr<Heuristic> along(Instance& parent, const Configuration& goal) {
    // A point that had no valid lift towards another goal may have one towards this goal.
    if (goal_choice_.replaced()) sparse_.emplace(projection_->space(), spacing_, projection_->arm());
    const PointLift lift = handles_ ? handles_->point_lift(parent) : projection_->point_lift(parent, variation_);
    SparsePath sparse = sparse_->validate(parent, path_, goal, lift);
    const double radius = settings_.radius > 0.0 ? settings_.radius : 0.5 * characteristic_length(parent);
    const StepHeuristic::Settings steps = {
        .radius = radius, .step = step_length(parent), .evidence = settings_.evidence};
    std::vector<char> known = known_edges(parent, sparse.waypoints);
    auto h = std::make_unique<StepHeuristic>("workspace", parent.space, std::move(sparse.waypoints), steps,
                                             nodes_.both(), std::move(known));
    steps_ = h.get();
    // If a path leads through a refuted place, there is no other path.
    if (path_is_refuted()) return h;
    if (sparse.refuted) {
      refuted_.push(*sparse.refuted);
      h->refute();
    }
    return h;
  }

  [[nodiscard]] bool path_is_refuted() const {
    const Space& space = projection_->space();
    for (std::size_t k = 0; k < refuted_.size(); ++k) {
      for (std::size_t i = 0; i + 1 < path_.size(); ++i) {
        const double distance =
            nearest_on_motion(space, std::as_const(path_)[i], std::as_const(path_)[i + 1], refuted_[k])
                .squared_distance;
        if (distance <= 0.25 * cell_ * cell_) return true;
      }
    }
    return false;
  }

  WorkspaceSettings settings_;
  std::shared_ptr<const PositionProjection> projection_;
  std::shared_ptr<const HandleLift> handles_;  ///< set if the option requests handles
  Instance* point_ = nullptr;                  ///< S, outlives this object
  std::shared_ptr<Graph> graph_;
  std::optional<ReachedIndex> reached_;  ///< positions of the planner's nodes
  bool along_path_ = false;              ///< h follows configurations of C
  ReachedNodes nodes_;                   ///< the planner's nodes, if `along_path_`
  std::optional<SparseValidation> sparse_;
  double spacing_ = 0.0;            ///< distance between validated points
  GoalChoice goal_choice_;          ///< where paths of S lead in C
  int variation_ = 0;               ///< number of further lifts of the path found
  Configurations refuted_;          ///< refuted places of paths
  StepHeuristic* steps_ = nullptr;  ///< active h, if any
  Configurations path_;             ///< found in S
  double cell_ = 0.0;
  double radius_ = 0.0;
};

}  // namespace

GuideKind workspace_kind() {
  return {
      &workspace_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return std::make_unique<Workspace>(workspace_settings().read(o));
      },
      "graph_search",
      [](const Options& o) { return workspace_settings().read(o).resolves; },
      {.category = GuideClaims::Category::robot,
       .f =
           "q -> the position of the reference point, free in the workspace; of an arm that is fixed to its base, that "
           "of its tip, as far as it reaches",
       .h = "a position from a tube about the point's path, just beyond what the tree has reached, with uniform "
            "angles; of an arm, and of a robot that handle points place on the medial axis, a ball about a "
            "configuration a step ahead of the tree on the path lifted",
       .closed_form = true,
       .density = "of the tube of positions times that of the angles",
       .feedback =
           "new nodes move the stretch on; after `evidence` blocked proposals at one place edges not yet reached "
           "cost more and S is solved again",
       .relaxes = true,
       .invalid_ends = "S has no path; the point of a robot that covers it is valid wherever the robot is",
       .fallback = GuideClaims::Fallback::nearest,
       .no_path = "h follows the path to the node nearest to the goal; uniform where that is the "
                  "start alone. Passages narrower than a cell may be missed",
       .example = "examples/workspace.lua",
       .needs = GuideClaims::Needs::position},
      true};
}

}  // namespace trellis
