// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/verified_motions.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// Decides validity for an instance: by collision checks, or by the presumption of a guiding space. Configurations
/// have the dimension of the instance's space, which is not checked: another size is undefined behaviour.
/// It may have scratch memory: only one thread may use it at a time.
class Validity {
 public:
  virtual ~Validity() = default;
  /// Whether q is valid. False outside of the space, where the implementation checks that.
  /// \param q  a configuration, or a state of the motion model
  [[nodiscard]] virtual bool state(View q) = 0;
  /// Checks the motion from a valid `a` to `b`, with the ends as in Checker::motion.
  /// \param a  valid; it is not checked
  /// \param b  checked
  [[nodiscard]] virtual MotionReport motion(View a, View b) = 0;
  /// Announces the checks of a motion that a validity made for another thread has checked, as `motion` announces them.
  /// \param a, b  the ends of the motion
  /// \param report  of that motion
  virtual void announce(View a, View b, const MotionReport& report) {
    static_cast<void>(a);
    static_cast<void>(b);
    static_cast<void>(report);
  }
  /// Adds the motion from a to b, both included, to a certificate that is valid so far. Where no collision check
  /// decides validity, a motion is checked as `motion` checks it.
  /// \param a, b  the ends of the motion
  /// \param certificate  receives the number of checks, and the place where the motion is refuted
  virtual void certify(View a, View b, Certificate& certificate) {
    const MotionReport report = motion(a, b);
    certificate.checks += report.checks;
    if (!report.valid) certificate.refuted_at = report.invalid_at;
  }
  /// Returns the clearance in metres of the workspace; infinity where the space presumes q free.
  /// \param q  valid or not; 0 in collision
  [[nodiscard]] virtual double clearance(View q) = 0;
  /// False where deciding costs no collision checks (presumed validity): the instance then counts none.
  [[nodiscard]] virtual bool spends_checks() const { return true; }
  /// Whether q is valid in the space that this one relaxes, or in this space where it relaxes none. A path of this
  /// space needs only configurations that are valid there.
  /// \param q  a configuration of this space
  [[nodiscard]] virtual bool needed(View q) { return state(q); }
  /// Returns the contact at q; none for a valid q, or where no collision check decides validity.
  /// \param q  a configuration of this space
  [[nodiscard]] virtual std::optional<Contact> contact(View q) {
    static_cast<void>(q);
    return {};
  }
  /// Returns the obstacle of the instance's world that is nearest to the robot at q; none without obstacles.
  /// \param q  finite coordinates
  /// \throws Error where no collision check decides validity: such a space has no distances to obstacles
  [[nodiscard]] virtual std::optional<Proximity> nearest_obstacle(View q);
  /// The validity by collision checks that this one presumes, excludes from, or asks after another; nullptr: this one
  /// checks.
  [[nodiscard]] virtual std::shared_ptr<Validity> checking() const { return nullptr; }
  /// A counter that grows each time the valid set may have changed: planners then recheck their motions.
  [[nodiscard]] virtual std::uint64_t epoch() const { return 0; }
  /// Whether a motion that was valid at an earlier epoch still is. Costs no validity check where the implementation
  /// stores the newly invalid regions; by default calls `motion`.
  /// \param a, b  the ends of the motion
  /// \param since  an epoch at which the motion was valid; 0: not known
  [[nodiscard]] virtual MotionReport motion_still_valid(View a, View b, std::uint64_t since) {
    static_cast<void>(since);
    return motion(a, b);
  }
  /// Factor on the cost of an edge for searches of roadmaps, >= 1; above 1 where validating the edge would still cost
  /// checks.
  /// \param a, b  the ends of the edge
  [[nodiscard]] virtual double effort_factor(View a, View b) const {
    static_cast<void>(a);
    static_cast<void>(b);
    return 1.0;
  }
  /// Returns the parameter in [0, 1] at which the motion from a to b enters an excluded region; none where it enters
  /// none. Costs no check.
  /// \param a, b  the ends of the motion
  [[nodiscard]] virtual std::optional<double> excluded(View a, View b) {
    static_cast<void>(a);
    static_cast<void>(b);
    return std::nullopt;
  }
  /// Whether the motion from a to b enters an excluded region, also one that refutes no path of another space. Costs no
  /// check.
  /// \param a, b  the ends of the motion
  [[nodiscard]] virtual bool enters_excluded(View a, View b) { return excluded(a, b).has_value(); }
  /// Returns a validity with the same answers, for another thread, until the epoch changes; nullptr where answers
  /// depend on what was asked before, or cannot be had twice.
  [[nodiscard]] virtual std::shared_ptr<Validity> for_thread() const { return nullptr; }
  /// What checks cost where they decide validity.
  [[nodiscard]] virtual const CheckCost& cost() const;
  /// Announces whether the next motions lead to a guided proposal, so that they are likely to lie on the solution path.
  /// \param guided  true: they lead to a guided proposal
  virtual void expect_guided(bool guided) { static_cast<void>(guided); }
  /// Returns a lower bound on the distance in the metric from an invalid q to the nearest valid configuration; 0 where
  /// no bound is available.
  /// \param q  invalid; it is not checked
  /// \return metres of the metric
  [[nodiscard]] virtual double invalid_radius(View q) {
    static_cast<void>(q);
    return 0.0;
  }
};

/// Returns Validity::checking() of a validity, or the validity itself where that is nullptr.
/// \param validity  not nullptr
inline std::shared_ptr<Validity> checking(const std::shared_ptr<Validity>& validity) {
  auto other = validity->checking();
  return other != nullptr ? other : validity;
}

/// Validity by a collision checker.
class CollisionValidity final : public Validity {
 public:
  /// \param make  makes the checker, and equal ones for other threads, by which it is called too; never returns nullptr
  /// \throws what `make` throws
  explicit CollisionValidity(std::function<std::unique_ptr<Checker>()> make)
      : make_(std::move(make)), checker_(make_()), cost_(checker_->cost()) {}
  /// These announce their checks (slice_monitor.hpp).
  [[nodiscard]] bool state(View q) override;
  [[nodiscard]] MotionReport motion(View a, View b) override;
  void announce(View a, View b, const MotionReport& report) override;
  void certify(View a, View b, Certificate& certificate) override { checker_->certify(a, b, certificate); }
  [[nodiscard]] double clearance(View q) override;
  [[nodiscard]] std::optional<Contact> contact(View q) override;
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) override;
  [[nodiscard]] double invalid_radius(View q) override { return checker_->invalid_radius(q); }
  [[nodiscard]] std::shared_ptr<Validity> for_thread() const override {
    return std::make_shared<CollisionValidity>(make_);
  }
  [[nodiscard]] const CheckCost& cost() const override { return cost_; }
  [[nodiscard]] const Checker& checker() const { return *checker_; }

 private:
  std::function<std::unique_ptr<Checker>()> make_;
  std::unique_ptr<Checker> checker_;
  CheckCost cost_;
};

/// An explicit graph in a space. A planner searches an instance with a graph exactly.
struct Graph {
  struct Edge {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    double cost = 0.0;
    Configurations points;  ///< the edge's polyline, both ends included; empty: straight
  };
  Configurations vertices;
  std::vector<Edge> edges;           ///< undirected
  std::uint32_t start = 0;           ///< a vertex
  std::vector<std::uint32_t> goals;  ///< vertices, at least one; a path to any of them solves the instance
  bool verified = true;        ///< all edges are valid; else the search validates the edges of its candidate paths
  std::uint64_t revision = 0;  ///< number of changes of costs since the graph was made

  /// Whether a path to this vertex solves the instance.
  /// \param vertex  index into `vertices`
  [[nodiscard]] bool is_goal(std::uint32_t vertex) const {
    return std::find(goals.begin(), goals.end(), vertex) != goals.end();
  }
  /// Changes the cost of an edge between two searches.
  /// \param edge  index into `edges`, which is not checked
  /// \param cost  at least 0
  void set_cost(std::size_t edge, double cost) {
    edges[edge].cost = cost;
    ++revision;
  }
  /// As above, relative to the present cost.
  /// \param edge  index into `edges`, which is not checked
  /// \param factor  at least 0
  void multiply_cost(std::size_t edge, double factor) { set_cost(edge, edges[edge].cost * factor); }
};

/// Spent checks, in total or of one level.
struct Checks {
  std::uint64_t validity = 0;  ///< configurations, those on motions included
  std::uint64_t motion = 0;    ///< motions
  std::uint64_t alone = 0;     ///< part of `validity`: not on motions
  double work = 0.0;           ///< of all these, in units of search_cost
  /// Work that is neither checks nor proposals, in units of search_cost: edges that a search of a graph considers,
  /// nodes and edges that a roadmap adds, presumed validity.
  double other = 0.0;

  /// Adds the checks and the work of another level.
  /// \param more  each of its counts is added
  Checks& operator+=(const Checks& more) {
    validity += more.validity;
    motion += more.motion;
    alone += more.alone;
    work += more.work;
    other += more.other;
    return *this;
  }
};

/// The work of lifting from projections of an instance, in units of search_cost (search_cost::kinematics). The
/// projections share the counter with the instance that they were made of; a copy of the instance has a counter of its
/// own.
class LiftWork {
 public:
  LiftWork() : total_(std::make_shared<double>(0.0)) {}
  /// Makes a counter of its own at 0.
  /// \param other  unchanged; its work is not copied
  LiftWork(const LiftWork& other) : LiftWork() { static_cast<void>(other); }
  /// Replaces the counter by one of its own at 0.
  /// \param other  unchanged; its work is not copied
  LiftWork& operator=(const LiftWork& other) {
    if (this != &other) total_ = std::make_shared<double>(0.0);
    return *this;
  }
  LiftWork(LiftWork&&) noexcept = default;
  LiftWork& operator=(LiftWork&&) noexcept = default;
  ~LiftWork() = default;

  /// The work so far.
  [[nodiscard]] double total() const { return total_ ? *total_ : 0.0; }
  /// The counter, for projections of the instance: they add to it. nullptr after a move.
  [[nodiscard]] const std::shared_ptr<double>& shared() const { return total_; }

 private:
  std::shared_ptr<double> total_;
};

namespace search_cost {
/// The work of a configuration or motion that a space presumes valid. The other rates are in search_cost.hpp.
inline constexpr double presumed = 1.0;
}  // namespace search_cost

/// A motion planning instance (C, validity, s, t, motion model): the input of a planner and of a guide's projection.
/// Views have the dimension of `space` (with a motion model they are states), which is not checked. An instance belongs
/// to one level of one run: only the thread of that run may use it. Functions that check validity count the checks in
/// `checks`, and throw what the validity throws (a function of a script may fail).
class Instance {
 public:
  Space space;
  std::shared_ptr<const Scene> scene;  ///< world and robot, for guides that use the geometry
  std::shared_ptr<Validity> validity;
  std::shared_ptr<Graph> graph;  ///< nullptr: a sampling planner searches the space
  Configuration start;
  std::vector<Configuration> goals;  ///< at least one; each solves the instance
  double goal_tolerance = 1e-6;  ///< metres of the metric: a configuration within this distance of a goal is that goal
  double resolution = 0.05;      ///< metres that the robot's fastest point moves between two checked configurations
  double shared_resolution = 0.0;  ///< of C, where motions of this space are checked there too; 0: they are not
  /// The least clearance, in metres, of the reference point's path in every solution of the instances that this one was
  /// projected from. A path in this space with less clearance guides to none of their solutions.
  double needed_clearance = 0.0;
  /// Of a relaxed space: the largest distance, in metres, from the reference point to a point of the robot that follows
  /// the paths of this space.
  double needed_reach = 0.0;
  std::string collision = "planar";  ///< name of the collision backend: collision_backends()
  double step = 0.0;    ///< longest extension of the planner of this space, metres in the metric; 0: it has none
  bool guided = false;  ///< a guide guides the search of this space
  std::shared_ptr<const MotionModel> motion_model;  ///< nullptr: straight motions; else `space` is its state space
  std::vector<std::size_t> position_axes;           ///< the axes of the reference point's position; empty: none
  /// Creates validity for a scene where the axes are not the robot's; empty where they are.
  std::function<std::shared_ptr<Validity>(const std::shared_ptr<const Scene>&)> validity_of;

  /// Returns the number of validity checks of a motion one metre long.
  [[nodiscard]] double checks_per_metre() const {
    return 1.0 / resolution + (shared_resolution > 0.0 ? 1.0 / shared_resolution : 0.0);
  }
  /// Returns the first goal, the one of statistics where none was reached.
  [[nodiscard]] const Configuration& goal() const { return goals.front(); }
  /// The goal nearest to a configuration.
  struct NearGoal {
    std::size_t goal = 0;   ///< index into goals
    double distance = 0.0;  ///< metres of the metric
  };
  /// Returns the goal with the least distance from q in the metric; the first of equally distant ones.
  /// \param q  configuration of `space`
  [[nodiscard]] NearGoal nearest_goal(View q) const;
  /// Returns the distance from q to the nearest goal, in metres of the metric.
  /// \param q  configuration of `space`
  [[nodiscard]] double to_goal(View q) const { return nearest_goal(q).distance; }

  /// What this thread had announced before checks that are counted next (slice_monitor.hpp).
  struct Announced {
    bool monitored = false;
    double checks = 0.0;
    double work = 0.0;
    double on_motion = 0.0;  ///< rates of checks until these are counted
    double alone = 0.0;
  };
  /// Called before checks that one of the functions below counts: what they announce costs what checks of this
  /// instance cost.
  [[nodiscard]] Announced open_checks() const { return open_checks(validity->cost()); }
  /// Counts configurations that are on no motion.
  /// \param before  what `open_checks` returned before the checks
  /// \param number  of configurations
  /// \throws SearchEnded where the search may not continue
  void count_alone(const Announced& before, std::uint64_t number = 1) {
    checks.alone += number;
    count(before, number, static_cast<double>(number) * validity->cost().alone);
  }
  /// Counts a motion with so many configurations.
  /// \param before  what `open_checks` returned before the checks
  /// \param number  of configurations on the motion
  /// \throws SearchEnded where the search may not continue
  void count_motion(const Announced& before, std::uint64_t number) {
    const CheckCost& cost = validity->cost();
    ++checks.motion;
    count(before, number, cost.motion + static_cast<double>(number) * cost.on_motion);
  }
  /// The same before checks that `count_certificate` counts.
  [[nodiscard]] Announced open_certificate() const { return open_checks(certificate_cost()); }
  /// Counts a motion with the checks of its certificate.
  /// \param before  what `open_certificate` returned before the checks
  /// \param number  of configurations that the certificate checked
  /// \throws SearchEnded where the search may not continue
  void count_certificate(const Announced& before, std::uint64_t number) {
    const CheckCost cost = certificate_cost();
    ++checks.motion;
    count(before, number, cost.motion + static_cast<double>(number) * cost.on_motion);
  }
  /// Counts a distance from obstacles, which is one check.
  /// \param before  what `open_checks` returned before the distance
  /// \throws SearchEnded where the search may not continue
  void count_distance(const Announced& before) {
    ++checks.alone;
    count(before, 1, validity->cost().distance);
  }
  /// Calls `decide`, which checks one configuration, and counts the check.
  /// \param decide  called once, without arguments
  /// \return what `decide` returns
  /// \throws SearchEnded where the search may not continue, and what `decide` throws
  template <class Decide>
  auto check_one(const Decide& decide) {
    const Announced before = open_checks();
    auto result = decide();
    count_alone(before);
    return result;
  }
  /// Calls `certify`, which checks a motion by a certificate, and counts its checks.
  /// \param certify  called once, without arguments; returns a MotionReport
  /// \return what `certify` returns
  /// \throws SearchEnded where the search may not continue, and what `certify` throws
  template <class Certify>
  MotionReport check_certificate(const Certify& certify) {
    const Announced before = open_certificate();
    const MotionReport report = certify();
    count_certificate(before, report.checks);
    return report;
  }
  /// Calls `decide`, which checks a motion, and counts its checks.
  /// \param decide  called once, without arguments; returns a MotionReport
  /// \return what `decide` returns
  /// \throws SearchEnded where the search may not continue, and what `decide` throws
  template <class Decide>
  MotionReport check_motion(const Decide& decide) {
    const Announced before = open_checks();
    const MotionReport report = decide();
    count_motion(before, report.checks);
    return report;
  }

  /// Calls `measure`, which finds a distance from obstacles, and counts it.
  /// \param measure  called once, without arguments
  /// \return what `measure` returns
  /// \throws SearchEnded where the search may not continue, and what `measure` throws
  template <class Measure>
  auto measure_distance(const Measure& measure) {
    if (!validity->spends_checks()) {
      spend(search_cost::presumed);
      return measure();
    }
    const Announced before = open_checks();
    auto result = measure();
    count_distance(before);
    return result;
  }

  /// Checks the state and counts the check.
  /// \param q  a configuration, or a state of the motion model
  [[nodiscard]] bool valid(View q) {
    if (validity->spends_checks()) return check_one([&] { return validity->state(q); });
    spend(search_cost::presumed);
    return validity->state(q);
  }
  /// Whether the motion was verified since the last change of the instance.
  /// \param a, b  the ends of the motion, in either order
  [[nodiscard]] bool is_verified(View a, View b) const {
    return verified && verified->epoch() == epoch() && verified->contain(a, b);
  }
  /// Announces a proposal, which is counted next (slice_monitor.hpp).
  static void announce_proposal();
  /// Counts work that is neither checks nor proposals, and announces it (slice_monitor.hpp).
  /// \param work  in units of search_cost
  void spend(double work);
  /// Checks and counts the motion, unless it was verified before: then it counts no check.
  /// \param a  valid; the caller has checked it
  /// \param b  checked
  /// \param known  the validity's report of this motion, where it was asked before; nullptr: asks it
  [[nodiscard]] MotionReport motion(View a, View b, const MotionReport* known = nullptr) {
    if (is_verified(a, b)) {
      spend(search_cost::presumed);
      return {true, 0, std::numeric_limits<double>::quiet_NaN()};
    }
    if (!validity->spends_checks()) {
      spend(search_cost::presumed);
      return known != nullptr ? *known : validity->motion(a, b);
    }
    return check_motion([&] {
      if (known == nullptr) return validity->motion(a, b);
      validity->announce(a, b, *known);
      return *known;
    });
  }
  /// Checks whether a motion that was valid at an earlier epoch still is, and counts the checks.
  /// \param a, b  the ends of the motion
  /// \param since  an epoch at which the motion was valid, if known: only later changes are considered
  [[nodiscard]] MotionReport recheck_motion(View a, View b, std::uint64_t since = 0) {
    // Epochs before the present projection say nothing of its validity.
    const Announced before = open_checks();
    const MotionReport report = validity->motion_still_valid(a, b, since > revision ? since - revision : 0);
    if (validity->spends_checks() && report.checks > 0) {
      count_motion(before, report.checks);
    } else {
      close_checks(before);
      spend(search_cost::presumed);
    }
    return report;
  }
  /// As recheck_motion, without the report.
  /// \param a, b  the ends of the motion
  /// \param since  an epoch at which the motion was valid; 0: not known
  [[nodiscard]] bool motion_still_valid(View a, View b, std::uint64_t since = 0) {
    return recheck_motion(a, b, since).valid;
  }
  /// Propagates from a valid state under a constant control for at most `steps` steps, up to the first invalid state.
  /// Appends the state after each valid step. Each step counts as a motion. Requires a motion model.
  /// \param from  valid; it is not checked
  /// \param control  a number for each control of the model, within its bounds
  /// \param steps  of the motion model
  /// \param states  receives the valid states, without `from`
  /// \param blocked  if not null: receives the first invalid state
  /// \return the number of valid steps
  std::uint32_t drive(View from, View control, std::uint32_t steps, Configurations& states,
                      Configuration* blocked = nullptr);

  /// Returns the validity in this space with another scene's world and robot. It always checks collisions, even where
  /// this space presumes validity.
  /// \param other  of the same kind as `scene`, with as many coordinates; not nullptr
  /// \throws Error as make_validity does
  [[nodiscard]] std::shared_ptr<Validity> validity_in(const std::shared_ptr<const Scene>& other) const;

  /// Returns the clearance at q in metres of the workspace (Validity::clearance). It counts as one validity check, with
  /// the work of a distance.
  /// \param q  valid or not; 0 in collision
  [[nodiscard]] double clearance(View q) {
    return measure_distance([&] { return validity->clearance(q); });
  }

  /// Returns the nearest obstacle; counts as `clearance` does.
  /// \param q  finite coordinates
  /// \throws Error where no collision check decides validity
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) {
    return measure_distance([&] { return validity->nearest_obstacle(q); });
  }

  /// The work that is neither checks nor proposals, in validity checks of this instance.
  [[nodiscard]] double other_in_checks() const {
    return (checks.other + lift_work.total()) / std::max(1.0, validity->cost().alone);
  }
  /// A counter that grows each time the valid set may have changed: through the validity, or through a new projection.
  [[nodiscard]] std::uint64_t epoch() const { return revision + validity->epoch(); }

  Checks checks;
  LiftWork lift_work;
  std::shared_ptr<VerifiedMotions> verified;  ///< valid motions; nullptr: does not store them
  std::uint64_t revision = 0;                 ///< grows when a new projection replaces the instance

 private:
  void count(const Announced& before, std::uint64_t number, double work) {
    if (before.monitored) settle(before, static_cast<double>(number), work);
    checks.validity += number;
    checks.work += work;
    if (before.monitored) ask();
  }
  [[nodiscard]] static Announced open_checks(const CheckCost& cost);
  /// Checks of certificates are distances, for the most part cut short.
  [[nodiscard]] CheckCost certificate_cost() const {
    constexpr double share = 0.125;
    CheckCost cost = validity->cost();
    cost.on_motion = std::max(cost.on_motion, share * cost.distance);
    return cost;
  }
  /// Ends `open_checks` without checks that count.
  static void close_checks(const Announced& before);
  /// Makes what was announced since `open_checks` what is counted now.
  static void settle(const Announced& before, double number, double work);
  /// Asks whether the search may continue, if it has announced more than a slice.
  /// \throws SearchEnded if not
  static void ask();
};

/// Returns validity by collision checks and, with a motion model, by its limits and the bounds of its states.
/// \param collision  the name of a backend of the scene
/// \param scene  not nullptr
/// \param space  of the configurations; with a motion model of its states
/// \param resolution  metres that the robot's fastest point moves between two checked configurations
/// \param motion_model  nullptr: motions are straight
/// \throws Error for a backend that the scene has not, a resolution that is not finite and greater than 0, a robot
///     without bodies, and a space with fewer coordinates than the robot
std::shared_ptr<Validity> make_validity(const std::string& collision, const std::shared_ptr<const Scene>& scene,
                                        const Space& space, double resolution,
                                        const std::shared_ptr<const MotionModel>& motion_model);

/// Returns the instance of a problem in the configuration space of the real robot. Does not validate the problem:
/// `check` does (strategy/executor.hpp).
/// \param problem  with a scene and at least one goal; `reach` is not read, because the goals were chosen from it
/// \throws Error for an unknown collision backend, a resolution that is not finite and greater than 0, and a space with
///     fewer coordinates than the robot
std::unique_ptr<Instance> make_instance(const Problem& problem);

/// Returns the start and the goals with their names in messages: "start", "goal", or "goal 1" and so on where there are
/// several. Without a goal the second is empty.
/// \param problem  not validated
std::vector<std::pair<std::string, Configuration>> named_ends(const Problem& problem);

/// Sorts the goals of an instance in S by distance from its start, and equally distant ones by their coordinates, so
/// that S does not depend on the order of the parent's goals. Removes repeated goals, and goals outside of S unless all
/// are.
/// \param sub  its start and goals are those of S
void sort_goals(Instance& sub);

/// Sets the start and the goals of an instance in S to f of the parent's, and sorts the goals (sort_goals).
/// \param f  has `project(View q, MutableView s)`
/// \param parent  the instance in C, with at least one goal
/// \param sub  its space is S
template <typename F>
void project_ends(const F& f, const Instance& parent, Instance& sub) {
  sub.start.resize(sub.space.dimension());
  f.project(parent.start, sub.start);
  sub.goals.assign(parent.goals.size(), Configuration(sub.space.dimension()));
  for (std::size_t i = 0; i < parent.goals.size(); ++i) f.project(parent.goals[i], sub.goals[i]);
  sort_goals(sub);
}

}  // namespace trellis
