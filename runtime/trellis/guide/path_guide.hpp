// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by guides whose space S has the coordinates of C and whose h is a tube about the path found in S.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/excluded.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/guide/kernels.hpp>
#include <trellis/guide/reached_nodes.hpp>
#include <trellis/guide/relaxed.hpp>
#include <trellis/planner/composed.hpp>

namespace trellis {

class KeptTree;
class SparseValidation;

/// Lifts a point of a path in S to C, in several attempts.
/// \param attempt  0 for the first; each attempt gives another configuration
/// \param s  the point of the path in S
/// \param previous  in C: the previous waypoint, or the next one if the path is validated from its end; if so
///     requested, interpolated towards the waypoint at the other end of the part that is not yet validated
/// \param ahead  the next point of the path in S in the direction of validation; `s` at the end
/// \param q  receives the configuration
/// \return false if there are no more attempts
using PointLift = std::function<bool(int attempt, View s, View previous, View ahead, Stream& stream, MutableView q)>;

/// How a guiding path is followed (option `follow`).
enum class Follow : std::uint8_t {
  steps,     ///< its points are validated in C, and proposals are a step ahead of the search
  tube,      ///< proposals from the tube about the stretch beyond what the search has reached
  waypoints  ///< its points in turn
};

struct PathGuideSettings {
  double radius = 0.0;
  Follow follow = Follow::steps;
  double window = 0.0;
  double spacing = 0.0;
  std::int64_t evidence = 60;
  std::int64_t resolves = 1000;
  std::int64_t paths = 1;
  double distinct = 0.0;
  bool inhibit_bottlenecks = false;
  std::int64_t effort = 2000;
  bool keep_tree = false;
};

template <class S>
Settings<S> with_radius(Settings<S> settings) {
  return settings.number(
      "radius", &S::radius, "m in the metric", Range::non_negative(),
      "radius of the tube about the path that proposals are drawn from; 0: half the robot's bounding radius, or of the "
      "space's diameter 1 % for a point and 5 % for a robot that is fixed to its base");
}

/// The options that follow a tube.
template <class S>
Settings<S> with_progress(Settings<S> settings) {
  return settings
      .number(
          "window", &S::window, "m in the metric", Range::non_negative(),
          "how far beyond what the planner has reached a tube's proposals are drawn; 0: two of the planner's steps, "
          "or two bounding radii where it has none")
      .integer("evidence", &S::evidence, "proposals", Range::at_least(1),
               "guided proposals at one place of the path that C found blocked, after which the path is refuted");
}

/// The options that follow a path.
template <class S>
Settings<S> with_following_options(Settings<S> settings) {
  return with_progress(
      with_radius(std::move(settings))
          .choice(
              "follow", &S::follow,
              {{"steps", Follow::steps}, {"tube", Follow::tube}, {"waypoints", Follow::waypoints}},
              "how the path is followed: \"steps\", its points are validated in C `spacing` apart, and proposals are a "
              "step of the planner ahead of the node that came farthest along it; \"tube\", from the stretch of it "
              "just beyond what the planner has reached; \"waypoints\", its points in turn: one that is valid in C is "
              "proposed itself, and where that was blocked half the time what is near it; one that is not, what is "
              "near it")
          .number("spacing", &S::spacing, "m in the metric", Range::non_negative(),
                  "distance between the points of the path in S that are validated in C before it guides by "
                  "\"steps\"; 0: 0.8 of the planner's step, or the robot's bounding radius where that is more (of the "
                  "space's diameter 2 % for a point and 10 % for a robot that is fixed to its base)"));
}

template <class S>
Settings<S> with_resolves(Settings<S> settings) {
  return settings.integer("resolves", &S::resolves, "re-solves", Range::non_negative(),
                          "how often its space may be solved again");
}

template <class S>
Settings<S> with_path_options(Settings<S> settings) {
  return with_resolves(with_following_options(std::move(settings)));
}

/// The options of guides that can search for several paths.
template <class S>
Settings<S> with_several_paths(Settings<S> settings) {
  settings
      .integer("paths", &S::paths, "paths", {.lo = 1, .hi = 64},
               "guiding paths that are looked for, each distinct from those before it; all found guide at once")
      .number("distinct", &S::distinct, "m in the metric", Range::non_negative(),
              "distance that a further path keeps from those before it, but near their ends; 0: the robot's bounding "
              "radius in C, or of the space's diameter 2 % for a point and 10 % for a robot that is fixed to its base")
      .choice("inhibit", &S::inhibit_bottlenecks, {{"paths", false}, {"bottlenecks", true}},
              "what a further path keeps that distance from: \"paths\", all of those before it; \"bottlenecks\", their "
              "points that are invalid in C, so that paths differ only where C may not follow them, and a path without "
              "such a point is the last one")
      .integer("effort", &S::effort, "proposals", Range::at_least(1), "budget of the search for each further path");
  return settings;
}

/// The claims shared by guides of this kind: h, its density and feedback, and the fallback without a path.
GuideClaims path_claims(GuideClaims::Category category, std::string f, std::string invalid_ends, std::string example);

/// Default distance between the points of a path that an instance validates, in metres in the metric: the
/// characteristic length, or 0.8 of the planner's step if that is larger.
double sparse_spacing(const Instance& instance);

/// The tube's radius in an instance, in metres in the metric: the option `radius` or its default.
double tube_radius(const PathGuideSettings& settings, const Instance& instance);

/// h that follows a path in C.
class PathFollower : public Heuristic {
 public:
  [[nodiscard]] bool stale() const final { return stale_; }
  /// Marks the path as refuted: h becomes stale.
  void refute() { stale_ = true; }
  /// The point of the path at which evidence refuted it, if any.
  [[nodiscard]] virtual std::optional<Configuration> refuted_place() const { return std::nullopt; }
  /// Radius of the tube about the path, in metres in the metric.
  [[nodiscard]] virtual double radius() const = 0;

 private:
  bool stale_ = false;
};

/// h along a path in C: a tube about the part of the path just beyond the planner's nodes.
class PathHeuristic final : public PathFollower {
 public:
  /// \param reached  the planner's nodes so far, which cover parts of the path; nullptr: none
  /// \param window  metres in the metric
  /// \param evidence  number of blocked proposals that refutes the path
  PathHeuristic(std::string source, const Space& space, Configurations path, double radius, double window,
                std::int64_t evidence, const ReachedIndex* reached);

  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  void record(DensityRecord& record, double share) const override { record.add(tube_.density(), share); }
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] std::vector<std::string> sources() const override { return {source_}; }
  [[nodiscard]] Configurations lifted_path() const override { return tube_.path(); }
  [[nodiscard]] double radius() const override { return tube_.radius(); }
  [[nodiscard]] double progress() const override { return progress_; }
  [[nodiscard]] std::optional<Configuration> refuted_place() const override { return refuted_place_; }

 private:
  void choose_stretches();
  /// Marks the bins of the path that q covers. Returns whether it marked a new one.
  bool cover(View q);
  /// Counts a blocked proposal at the nearest bin that is not covered.
  void count_blocked(View blocked_at);

  std::string source_;
  Space space_;
  TubeKernel tube_;
  double window_;
  std::int64_t evidence_;
  std::int64_t blocked_ = 0;                  ///< guided proposals blocked since the last progress
  std::vector<std::int64_t> blocked_in_bin_;  ///< of them, the number for each bin
  std::optional<Configuration> refuted_place_;
  double progress_ = 0.0;
  std::uint64_t epoch_ = 0;    ///< number of changes of the intervals
  double bin_ = 0.0;           ///< arc length of one bin
  Configurations centres_;     ///< centres of the bins
  std::vector<char> covered_;  ///< for each bin, whether a node of the planner covers it
  std::size_t uncovered_ = 0;
};

/// h along the waypoints of a path in C, one after another, as iterative relaxation of constraints repairs a path. A
/// waypoint that is valid in C is proposed itself; after a blocked motion to it, configurations near it are proposed
/// too. For an invalid waypoint, only configurations near it are proposed. A node near a waypoint reaches it. After the
/// last waypoint, proposals come from the tube about the whole path.
class WaypointHeuristic final : public PathFollower {
 public:
  /// \param reached  the planner's nodes, with at least the start; outlives this object and is kept current
  WaypointHeuristic(std::string source, Instance& parent, Configurations path, double radius, std::int64_t evidence,
                    const ReachedIndex& reached);

  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  void record(DensityRecord& record, double share) const override;
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] std::vector<std::string> sources() const override { return {source_}; }
  [[nodiscard]] Configurations lifted_path() const override { return tube_.path(); }
  [[nodiscard]] double radius() const override { return tube_.radius(); }
  [[nodiscard]] double progress() const override { return progress_; }
  [[nodiscard]] std::optional<Configuration> refuted_place() const override {
    if (!stale() || at_ >= tube_.path().size()) return std::nullopt;
    const View place = tube_.path()[at_];
    return Configuration(place.begin(), place.end());
  }
  /// For a verified path, the tree from the goal visits the waypoints from the last one backwards.
  void select_tree(TreeSide side) override { backwards_ = exact_ && side == TreeSide::goal && back_ > at_; }
  /// Extends the node at the previous waypoint.
  [[nodiscard]] std::uint32_t vertex() const override {
    if (!drew_itself_ || draw_ != Draw::itself) return no_node;
    return backwards_ ? back_row_ : row_;
  }
  /// Connects trees along a verified path only once both have reached the same waypoint.
  [[nodiscard]] bool worth_connecting(View, View) const override { return !exact_ || back_ <= at_; }
  /// The current waypoint, a row of the path; the path's size after the last one.
  [[nodiscard]] std::size_t waypoint() const { return at_; }

 private:
  enum class Draw : std::uint8_t { itself, both, near };

  /// The probability of the waypoint itself among the proposals.
  [[nodiscard]] double share_of_waypoint() const;
  /// Advances past the waypoints that are reached, and checks the next one.
  void go_on();

  std::string source_;
  Instance& parent_;
  TubeKernel tube_;
  std::vector<double> lengths_;  ///< arc length up to each waypoint
  std::int64_t evidence_;
  const ReachedIndex& reached_;
  std::size_t at_ = 0;
  Draw draw_ = Draw::near;
  bool drew_itself_ = false;
  bool exact_ = false;           ///< the path was verified: a node reaches a waypoint only at the waypoint itself
  std::uint32_t row_ = no_node;  ///< node that reached the last waypoint
  bool backwards_ = false;       ///< the next proposal is for the tree from the goal
  std::size_t back_ = 0;         ///< the tree from the goal has reached the waypoints from this one to the last
  std::uint32_t back_row_ = no_node;
  std::int64_t blocked_ = 0;  ///< guided proposals blocked at this waypoint
  double progress_ = 0.0;
  std::uint64_t epoch_ = 0;
};

/// h along several paths: each path that is not stale has an equal share.
class SeveralPaths final : public Composed<PathFollower> {
 public:
  /// \param parts  at least one
  explicit SeveralPaths(std::vector<std::unique_ptr<PathFollower>> parts);

  Source sample(Stream& stream, MutableView out) override;
  /// The minimum over the active paths.
  [[nodiscard]] std::optional<double> edge_factor(View a, View b) const override;
  [[nodiscard]] std::optional<Configuration> refuted_place() const override;
  [[nodiscard]] std::uint64_t epoch() const override;
  void record(DensityRecord& record, double share) const override;
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] std::vector<std::string> sources() const override { return parts_.front()->sources(); }
  [[nodiscard]] Configurations lifted_path() const override { return parts_[live_.front()]->lifted_path(); }
  [[nodiscard]] double radius() const override { return parts_.front()->radius(); }

 private:
  [[nodiscard]] std::size_t part_count() const override { return parts_.size(); }
  [[nodiscard]] Guidance* part_at(std::size_t i) const override { return parts_[i].get(); }
  [[nodiscard]] Guidance* drew_last() const override { return parts_[drawn_].get(); }

  std::vector<std::unique_ptr<PathFollower>> parts_;
  std::vector<std::size_t> live_;  ///< paths that are not stale; never empty
  std::size_t drawn_ = 0;
  std::uint64_t changes_ = 0;  ///< number of changes of the active paths
};

/// Makes h along a path in C according to the settings.
/// \param reached  the nodes of the planner's trees, with at least the start; they outlive the result and are kept
///     current
std::unique_ptr<PathFollower> follow_path(const std::string& source, const PathGuideSettings& settings,
                                          Instance& parent, const Configurations& path,
                                          const std::array<const ReachedIndex*, 2>& reached);

/// A uniform h, for a space whose search found no path.
class UniformHeuristic final : public Heuristic {
 public:
  UniformHeuristic(std::string source, const Space& space) : source_(std::move(source)), uniform_(space) {}
  Source sample(Stream& stream, MutableView out) override { return uniform_.sample(stream, out); }
  void record(DensityRecord& record, double share) const override { uniform_.record(record, share); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {source_}; }

 private:
  std::string source_;
  UniformGuidance uniform_;
};

/// A guide with S = C as metric spaces: f is the identity on configurations.
class PathGuide : public Guide, public Repairs {
 public:
  PathGuide(std::string name, const PathGuideSettings& settings) : name_(std::move(name)), path_settings_(settings) {}

  std::unique_ptr<Instance> project(const Instance& parent) final;
  Repairs& repairs() final { return *this; }
  void attach(Instance& sub) override { sub_ = &sub; }
  void project(View q, MutableView s) const override { std::copy(q.begin(), q.end(), s.begin()); }
  void lift(View s, Stream&, MutableView q) const override { std::copy(s.begin(), s.end(), q.begin()); }
  [[nodiscard]] double log_fibre_density(View) const override { return 0.0; }
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override;
  void learn(const Outcome& outcome) override;
  void restart() override;
  void searched(const Search& search) override;
  std::int64_t another(const Solution* found) override;
  [[nodiscard]] double effort(bool again) const override {
    return again ? static_cast<double>(path_settings_.effort) : Budget::unlimited;
  }
  /// Excludes the refuted place from the next path in S.
  void before_resolve() override;
  void no_other_path() override { only_path_ = true; }
  [[nodiscard]] Configurations refuted_places() const override;
  void avoid(View place) override;
  Configurations take_lost_places() override { return std::exchange(lost_, Configurations(lost_.dimension())); }
  void found_invalid(View q) override;

 protected:
  /// f of the instance.
  virtual std::unique_ptr<Instance> reduced(const Instance& parent) = 0;
  /// The instance in whose space paths are followed and nodes are recorded: C, or S if h is lifted from S.
  [[nodiscard]] virtual const Instance& followed_in(const Instance& parent, const Instance&) const { return parent; }
  /// Whether a path in S may be invalid in C. If not, no evidence refutes it.
  [[nodiscard]] virtual bool relaxes() const { return true; }
  /// Whether `before_resolve` of this class excludes refuted places from S. A guide that treats them otherwise returns
  /// false.
  [[nodiscard]] virtual bool excludes() const { return relaxes(); }
  /// The option `follow` in use.
  [[nodiscard]] virtual Follow follow() const { return path_settings_.follow; }
  /// The path to follow, made from the path found in S.
  virtual Configurations followed(Configurations path) const { return path; }
  /// A copy of the instance without the state of its validity: the base from which f makes S.
  static std::unique_ptr<Instance> same_instance(const Instance& parent);
  /// The active heuristic; nullptr if the search found no path.
  [[nodiscard]] PathFollower* path_heuristic() const { return current_; }
  /// Whether a search for another path found none. The last path is then followed although it was refuted.
  [[nodiscard]] bool only_path() const { return only_path_; }
  /// Returns and clears the refuted point of the path in S, if any.
  [[nodiscard]] std::optional<Configuration> take_refuted();
  /// Whether a node of the planner lies within a distance of q, in metres in the metric.
  [[nodiscard]] bool reached(View q, double within) const {
    return reached_.begun() && reached_.from_start().squared_distance(q) <= within * within;
  }
  /// The planner's nodes that are connected to the start, and those connected to the goal.
  [[nodiscard]] const ReachedNodes& reached_nodes() const { return reached_; }
  /// Sets the paths that the next h follows, for a guide that finds several paths itself.
  void follow(std::vector<Configurations> paths) { paths_ = std::move(paths); }
  [[nodiscard]] const PathGuideSettings& path_settings() const { return path_settings_; }

 private:
  /// Follows the several paths found, else `path`.
  /// \param whole  whether the path ends at the goal
  [[nodiscard]] std::unique_ptr<PathFollower> follower(Instance& parent, const Configurations& path, bool whole);
  [[nodiscard]] std::unique_ptr<PathFollower> follower_of_one(Instance& parent, const Configurations& path, bool whole);
  /// Excludes a place from S unless it contains the start, or a goal and no other goal would remain.
  /// \return whether it is excluded
  bool exclude_place(View place);
  /// For S = C, which has lost what C has lost: refutes the path if it is no longer valid there. Costs no check.
  void refute_lost_path();
  [[nodiscard]] bool leads_through_lost_place(const Configurations& path) const;
  /// Excludes from S what the next path has to differ from. Returns whether to search for a next path.
  bool keep_apart_from(const Configurations& path);

  /// Lifts points of a path in S, which has the coordinates of C.
  [[nodiscard]] static PointLift near_point(const Instance& parent);
  /// Marks those motions of the path that were found valid in C as verified, so that C does not check them again.
  void share_verified(Instance& parent, const Configurations& path);

  std::string name_;
  PathGuideSettings path_settings_;
  PathFollower* current_ = nullptr;               ///< the last one made; its caller owns it
  std::optional<std::uint64_t> lost_checked_at_;  ///< epoch of S when `refute_lost_path` last checked `current_`
  Instance* sub_ = nullptr;
  bool only_path_ = false;  ///< a search for another one found none
  bool last_ = false;       ///< follow the next path although it is refuted: no other can exist
  ReachedNodes reached_;    ///< made once the space is known
  std::shared_ptr<SparseValidation> sparse_;
  std::optional<Configuration> refuted_;          ///< a point of the path in S that sparse validation refuted
  std::shared_ptr<RelaxedValidity> relaxed_;      ///< of S, if S relaxes C
  std::shared_ptr<ExcludingValidity> excluding_;  ///< of S, if it excludes paths or places
  std::shared_ptr<Validity> parents_;             ///< validity in C
  Configurations lost_;                           ///< places of S, excluded since the last take_lost_places
  std::optional<Places> found_invalid_;           ///< configurations of C found invalid since the last path
  // For guides that search for several paths:
  std::vector<Configurations> paths_;  ///< found since h was last made
  std::shared_ptr<KeptTree> tree_;     ///< of S, if it is kept
  std::vector<Configuration> goals_;   ///< of S before the search for the second path; empty: none is searched
  bool complete_ = false;              ///< no further path is required or exists
};

}  // namespace trellis
