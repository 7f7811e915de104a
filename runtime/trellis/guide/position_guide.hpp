// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by guides whose space S has the positions of the robot and an explicit graph.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/goal_choice.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/guide/path_steps.hpp>
#include <trellis/guide/position.hpp>
#include <trellis/guide/reached_nodes.hpp>

namespace trellis {

/// f: the position of the robot. h follows the path found in S, lifted to configurations of C, or is another one of the
/// derived class. Evidence in C, places that other guides of C refuted, and places that C itself lost increase the cost
/// of the graph's edges there; then the graph is searched again.
class PositionGuide : public Guide, public Repairs {
 public:
  Repairs& repairs() final { return *this; }
  void attach(Instance& sub) override { point_ = &sub; }
  void project(View q, MutableView s) const override { projection_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { projection_->lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View q) const override { return projection_->log_fibre_density(q); }
  [[nodiscard]] bool closed_fibre() const override { return projection_->closed_fibre(); }

  void learn(const Outcome& outcome) override;
  void restart() override;
  [[nodiscard]] Configurations refuted_places() const override;
  void avoid(View place) override;
  Configurations take_lost_places() override { return std::exchange(lost_, Configurations(lost_.dimension())); }
  void found_invalid(View q) override;

 protected:
  /// \param radius  of the balls about the lifted path, in metres in the metric; 0: half the characteristic length
  /// \param link    see PositionProjection
  PositionGuide(std::string name, std::int64_t evidence, double radius, std::vector<std::string> link)
      : name_(std::move(name)), evidence_(evidence), radius_option_(radius), link_(std::move(link)) {}

  /// Makes the instance of a point, without its graph.
  std::unique_ptr<Instance> point_instance(const Instance& parent);
  /// Called with the graph of the instance that `project` returns.
  /// \param lifts  whether h follows configurations of C along the path found
  /// \param spacing  between the points of the path that are validated, in metres in the metric; 0: the default
  void begin(const Instance& parent, Instance& instance, std::shared_ptr<Graph> graph, bool lifts,
             double spacing = 0.0);

  /// Begins to make h from the path found in S. Returns the goal of C that the path leads to.
  const Configuration& begin_heuristic(const Instance& parent, const Configurations& path);
  /// h along the path found, lifted to valid configurations of C.
  /// \param free  optional; points that need no check
  std::unique_ptr<Heuristic> along(Instance& parent, const Configuration& goal, const PointLift& lift,
                                   const PointIsFree& free = {});
  /// Sets another h that follows the path found; the caller owns it.
  void follow(PathFollower* follower) { follower_ = follower; }
  /// Whether `along` made the current h.
  [[nodiscard]] bool follows_steps() const { return steps_ != nullptr; }
  /// To be called before the graph is searched again, if `follows_steps`: excludes the place where the path was
  /// refuted.
  void exclude_refuted();

  /// Increases the cost of the path's edges near a position.
  virtual void exclude_on_path(View s) = 0;
  /// Increases the cost of the edges near a position that other evidence refuted.
  /// \return whether the path found leads through there; none if nothing was changed
  virtual std::optional<bool> exclude_near(View s) = 0;
  /// Whether S can exclude places: its search uses the costs of the graph. A planner that ignores them would find the
  /// same path again.
  [[nodiscard]] virtual bool can_exclude() const {
    return !graph_->edges.empty() && (point_ == nullptr || point_->graph != nullptr);
  }
  /// Whether the path found leads through an excluded place. If so, there is no other path.
  [[nodiscard]] virtual bool path_is_excluded() const = 0;

  [[nodiscard]] const std::shared_ptr<const PositionProjection>& projection() const { return projection_; }
  [[nodiscard]] const std::shared_ptr<Graph>& graph() const { return graph_; }
  /// The instance in S that is searched.
  [[nodiscard]] Instance& point() const { return *point_; }
  [[nodiscard]] const Configurations& path() const { return path_; }
  /// Whether h follows configurations of C along the path found.
  [[nodiscard]] bool lifts() const { return lifts_; }
  /// Number of further lifts of the path found.
  [[nodiscard]] int variation() const { return variation_; }
  /// Positions of the planner's nodes.
  [[nodiscard]] const ReachedIndex& reached() const { return *reached_; }
  /// Positions that were excluded.
  [[nodiscard]] const Configurations& excluded() const { return excluded_; }
  /// Radius of a place that another guide's evidence refuted, metres.
  [[nodiscard]] double place_radius() const { return place_radius_; }
  /// The point at which evidence refuted the path that h follows.
  [[nodiscard]] std::optional<Configuration> refuted_place() const {
    return follower_ != nullptr ? follower_->refuted_place() : std::nullopt;
  }
  /// Notes that S excludes a position from now on.
  void add_excluded(View s);

 private:
  std::string name_;
  std::int64_t evidence_;      ///< as the option says
  std::int64_t patience_ = 0;  ///< the same for the robot
  double radius_option_;
  std::vector<std::string> link_;
  std::shared_ptr<const PositionProjection> projection_;
  std::shared_ptr<Graph> graph_;
  Instance* point_ = nullptr;  ///< S, outlives this object
  Configuration start_;
  std::vector<std::size_t> position_axes_;
  double place_radius_ = 0.0;
  bool lifts_ = false;
  std::optional<ReachedIndex> reached_;
  ReachedNodes nodes_;  ///< the planner's nodes, if h lifts the path
  std::optional<SparseValidation> sparse_;
  double spacing_ = 0.0;  ///< distance between validated points
  GoalChoice goal_choice_;
  int variation_ = 0;
  Configurations path_;
  std::optional<Configuration> refuted_;  ///< point of `path_`
  StepHeuristic* steps_ = nullptr;        ///< active h, if it lifts the path
  PathFollower* follower_ = nullptr;      ///< active h, if it follows the path
  Configurations excluded_;
  Configurations lost_;                  ///< of `excluded_`, since the last take_lost_places
  std::optional<Places> found_invalid_;  ///< configurations of C found invalid since the path was found
};

}  // namespace trellis
