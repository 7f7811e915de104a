// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/excluded.hpp>
#include <trellis/guide/handles.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/position_guide.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/instance/grid_graph.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

namespace {

/// What completes a position (option `lift`).
enum class Lift : std::uint8_t { automatic, uniform, handles, path };

struct WorkspaceSettings {
  double cell = 0.0;
  double radius = 0.0;
  std::vector<std::string> point;
  Lift lift = Lift::automatic;
  std::vector<std::string> handles;
  double window = 0.0;
  std::int64_t evidence = 60;
  std::int64_t resolves = 1000;
};

const Settings<WorkspaceSettings>& workspace_settings() {
  static const Settings<WorkspaceSettings> settings =
      with_point(
          Settings<WorkspaceSettings>(
              Component::Kind::guide, "workspace",
              "the robot as a free point: the shortest path of its reference point among the obstacles, on a grid or "
              "by "
              "the "
              "planner given",
              "Holleman and Kavraki 2000, A framework for using the workspace medial axis in PRM planners; Denny, "
              "Sandstrom, Bregger and Amato 2016")
              .number(
                  "cell", &WorkspaceSettings::cell, "m", Range::non_negative(),
                  "side of a cell of the grid, whose edges run along sides and diagonals; 0: a fortieth, in space a "
                  "twentieth, of the longest "
                  "side of the space. Without effect where a planner is given that searches no graph")
              .number(
                  "radius", &WorkspaceSettings::radius, "m in the metric", Range::non_negative(),
                  "radius of the tube about the path that positions are drawn from; 0: the robot's bounding radius, or "
                  "1 % "
                  "of the space's diameter for a point; with `lift = \"path\"` or \"handles\", of the balls in C that "
                  "proposals are drawn from; 0: half the robot's bounding radius, or of C's diameter 1 % for a point, "
                  "5 % for "
                  "an arm and 7.5 % for a robot of a URDF file")
              .choice(
                  "lift", &WorkspaceSettings::lift,
                  {{"auto", Lift::automatic},
                   {"uniform", Lift::uniform},
                   {"handles", Lift::handles},
                   {"path", Lift::path}},
                  "what a position is completed with: \"uniform\", uniform angles (of an arm that is fixed to its "
                  "base, "
                  "any that bring its tip there); \"handles\", as \"path\", but the whole robot is moved and turned "
                  "until its handle points come no nearer to the medial axis of the workspace; of a robot with a "
                  "motion "
                  "model the path is moved to the axis and only the angles are drawn, the likelier the nearer its "
                  "handles come to the axis, and other coordinates are uniform; \"path\", as skeleton does: points of "
                  "the path are validated in C with angles that follow those before, and proposals are a step of the "
                  "planner ahead of the node that came farthest; \"auto\", \"path\" for an arm that is fixed to its "
                  "base "
                  "and \"uniform\" for any other robot")
              .names(
                  "handles", &WorkspaceSettings::handles,
                  "with `lift = \"handles\"`, points of the robot: \"x, y\" in the frame of its first body, or \"n: x, "
                  "y\" in that of its n-th; a body that turns and has none gets both ends of its longest direction")
              .number(
                  "window", &WorkspaceSettings::window, "m in the metric", Range::non_negative(),
                  "how far beyond what the planner has reached proposals are drawn; 0: two of the planner's steps, or "
                  "two bounding radii where it has none")
              .integer("evidence", &WorkspaceSettings::evidence, "proposals", Range::at_least(1),
                       "guided proposals at one place of the path that C found blocked, after which the path is "
                       "refuted; of a "
                       "robot of a URDF file so many for each three joints")
              .integer("resolves", &WorkspaceSettings::resolves, "re-solves", Range::non_negative(),
                       "how often its space may be solved again"))
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

/// Returns the length of the cells' sides, in metres, in a space of this dimension.
double side_of(const WorkspaceSettings& settings, std::size_t dimension, double longest) {
  const double cells = dimension == 2 ? 40.0 : 20.0;
  return settings.cell > 0.0 ? settings.cell : longest / cells;
}

/// Returns the number of cells along an axis.
/// \throws Error where these are too many
double cells_along(const std::string& axis, std::size_t dimension, double extent, double cell) {
  const double count = std::ceil(extent / cell);
  const double most = dimension == 2 ? most_cells : most_cells_in_space;
  if (count <= most) return count;
  throw Error(fmt::format("workspace: option 'cell' is {:g}, which makes {:g} cells along {}; expected at most {:g}",
                          cell, count, axis, most));
}

/// Returns the number of cells in a world.
/// \throws Error where these are too many along one axis
double cells_of(const Options& options, const Scene& scene) {
  // The space of an arm's tip is where it reaches.
  const double most = scene.translates() ? scene.diagonal() : 2.0 * scene.bounding_radius();
  std::vector<double> extents;
  if (const PlanarScene* const plane = scene.planar()) {
    const Vec2 all = plane->world.bounds().hi - plane->world.bounds().lo;
    extents = {all.x, all.y};
  } else {
    const Vec3 all = spatial_world(scene)->bounds().hi - spatial_world(scene)->bounds().lo;
    extents = {all.x, all.y, all.z};
  }
  for (double& extent : extents) extent = std::min(extent, most);
  const double cell = side_of(workspace_settings().read(options), extents.size(), std::ranges::max(extents));
  constexpr std::array names = {"x", "y", "z"};
  double all = 1.0;
  for (std::size_t j = 0; j < extents.size(); ++j) all *= cells_along(names.at(j), extents.size(), extents[j], cell);
  return all;
}

/// Makes the grid graph of the instance in S.
/// \throws Error if `cell` gives too many cells
std::shared_ptr<Graph> grid(const Instance& instance, double cell) {
  const std::vector<Axis>& axes = instance.space.axes();
  for (const auto& axis : axes) static_cast<void>(cells_along(axis.name, axes.size(), axis.hi - axis.lo, cell));
  return std::make_shared<Graph>(grid_graph(instance, cell));
}

class Workspace final : public PositionGuide {
 public:
  explicit Workspace(const WorkspaceSettings& settings)
      : PositionGuide("workspace", settings.evidence, settings.radius, settings.point), settings_(settings) {}

  using PositionGuide::project;
  std::unique_ptr<Instance> project(const Instance& parent) override {
    auto instance = point_instance(parent);
    const bool arm = projection()->arm();
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
    double longest = 0.0;
    for (const Axis& axis : instance->space.axes()) longest = std::max(longest, axis.hi - axis.lo);
    cell_ = side_of(settings_, instance->space.dimension(), longest);
    begin(parent, *instance, grid(*instance, cell_),
          !parent.motion_model &&
              (by_handles || settings_.lift == Lift::path || (arm && settings_.lift == Lift::automatic)));
    if (by_handles) {
      handles_ = std::make_shared<HandleLift>(
          projection(), parent, parse_handles("workspace", settings_.handles, planar(*parent.scene).robot));
    }
    return instance;
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution* found) override {
    const Configuration& goal = begin_heuristic(parent, found->path);
    if (path().size() < 2) return std::make_unique<UniformHeuristic>("workspace (found nothing)", parent.space);
    if (lifts() && found->solved()) {
      return along(parent, goal,
                   handles_ ? handles_->point_lift(parent) : projection()->point_lift(parent, variation()));
    }
    const Space& space = projection()->space();
    const double plain =
        projection()->arm() ? 0.01 * space.diameter() : size_or(*parent.scene, 0.01 * parent.space.diameter());
    radius_ = settings_.radius > 0.0 ? settings_.radius : plain;
    const double window = settings_.window > 0.0 ? settings_.window : 2.0 * step_length(parent);
    auto positions =
        std::make_unique<PathHeuristic>("workspace", space, handles_ ? handles_->on_axis(path(), point()) : path(),
                                        radius_, window, settings_.evidence, &reached());
    follow(positions.get());
    const std::shared_ptr<const Projection> lift =
        handles_ ? std::shared_ptr<const Projection>(handles_) : projection();
    return std::make_unique<LiftedHeuristic>(lift, space, std::move(positions), parent.start, goal,
                                             LiftedHeuristic::Points::atoms);
  }

  /// A planner that ignores the graph finds other paths where places are invalid.
  void attach(Instance& sub) override {
    PositionGuide::attach(sub);
    if (sub.graph) return;
    auto excluding =
        std::make_shared<ExcludingValidity>(sub.validity, sub.space, place_radius(), sub.position_axes, place_radius());
    if (excluding_) excluding->replace(*excluding_);
    excluding_ = std::move(excluding);
    sub.validity = excluding_;
  }

  /// Increases the cost of edges near the refuted place, or along the part of the path that the planner did not reach.
  void before_resolve() override {
    if (follows_steps()) {
      exclude_refuted();
      return;
    }
    // A path through a place that is excluded already costs more there.
    if (path_is_excluded()) return;
    if (excluding_) {
      const auto place = refuted_place();
      if (place && exclude(*place)) add_excluded(*place);
      return;
    }
    NearestIndex stuck(projection()->space());
    for (std::size_t i = 0; i < path().size(); ++i) {
      if (reached().squared_distance(path()[i]) > radius_ * radius_) stuck.add(path()[i]);
    }
    if (stuck.size() > 0) multiply_near(stuck, cell_, stuck_penalty);
  }

 private:
  void exclude_on_path(View s) override { refute(s, cell_); }
  std::optional<bool> exclude_near(View s) override {
    const double within = std::max(cell_, place_radius());
    for (std::size_t i = 0; i < excluded().size(); ++i) {
      if (projection()->space().squared_distance(excluded()[i], s) <= 0.25 * within * within) return std::nullopt;
    }
    refute(s, within);
    return leads_through(s, within);
  }
  [[nodiscard]] bool path_is_excluded() const override {
    for (std::size_t k = 0; k < excluded().size(); ++k) {
      if (leads_through(excluded()[k], 0.5 * cell_)) return true;
    }
    return false;
  }

  [[nodiscard]] bool leads_through(View s, double within) const {
    for (std::size_t i = 0; i + 1 < path().size(); ++i) {
      const double squared = nearest_on_motion(projection()->space(), path()[i], path()[i + 1], s).squared_distance;
      if (squared <= within * within) return true;
    }
    return false;
  }

  [[nodiscard]] bool can_exclude() const override { return excluding_ != nullptr || PositionGuide::can_exclude(); }
  /// Excludes a place from S unless it contains the start or a goal. Returns whether it did.
  bool exclude(View s) {
    std::vector<Configuration> keep = point().goals;
    keep.push_back(point().start);
    return excluding_->exclude_place(s, keep);
  }

  void refute(View s, double within) {
    if (excluding_) {
      exclude(s);
      return;
    }
    NearestIndex place(projection()->space());
    place.add(s);
    multiply_near(place, within, refuted_penalty);
  }

  /// Multiplies the costs of the edges whose middles are near one of some places.
  void multiply_near(const NearestIndex& places, double within, double penalty) {
    const Space& space = projection()->space();
    // The middle of an edge is at most half a diagonal of a cell from its end, so most edges need no look.
    double longest = 0.0;
    for (const Axis& axis : space.axes()) longest = std::max(longest, axis.weight);
    longest *= cell_ * std::sqrt(static_cast<double>(space.dimension()));
    const double reach = within + longest;
    std::vector<char> close(graph()->vertices.size());
    for (std::size_t v = 0; v < close.size(); ++v) {
      close[v] = places.nearest(std::as_const(graph()->vertices)[v]).squared_distance <= reach * reach ? 1 : 0;
    }
    Configuration middle(space.dimension());
    for (std::size_t e = 0; e < graph()->edges.size(); ++e) {
      const auto& edge = graph()->edges[e];
      if (close[edge.from] == 0) continue;
      space.interpolate(graph()->vertices[edge.from], graph()->vertices[edge.to], 0.5, middle);
      if (places.nearest(middle).squared_distance <= within * within) graph()->multiply_cost(e, penalty);
    }
  }

  WorkspaceSettings settings_;
  std::shared_ptr<const HandleLift> handles_;  ///< set if the option requests handles
  double cell_ = 0.0;
  double radius_ = 0.0;
  std::shared_ptr<ExcludingValidity> excluding_;  ///< of S, if its planner ignores the graph
};

}  // namespace

GuideKind workspace_kind() {
  return GuideKind{
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
           "cost more and S is solved again; with a planner that searches no graph S excludes the place",
       .relaxes = true,
       .invalid_ends = "S has no path; the point of a robot that covers it is valid wherever the robot is",
       .fallback = GuideClaims::Fallback::nearest,
       .no_path = "h follows the path to the node nearest to the goal; uniform where that is the "
                  "start alone. Passages narrower than a cell may be missed",
       .example = "examples/workspace.lua",
       .needs = GuideClaims::Needs::position},
      true}
      .set_up({.run = {200, 0.8}}, {.run = {4000, 8}}, cells_of);
}

}  // namespace trellis
