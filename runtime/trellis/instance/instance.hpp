// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/verified_motions.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// How an instance decides what is valid: by collision checks, or by what a guiding space presumes.
class Validity {
 public:
  virtual ~Validity() = default;
  [[nodiscard]] virtual bool state(View q) = 0;
  /// The motion from a valid `a` to `b`, both ends' validity as in Checker::motion.
  [[nodiscard]] virtual MotionReport motion(View a, View b) = 0;
  /// Distance to the nearest invalid configuration's contact, metres of the workspace; infinity where presumed free.
  [[nodiscard]] virtual double clearance(View q) = 0;
  /// False where deciding costs no collision checks (presumed validity): then nothing is counted.
  [[nodiscard]] virtual bool spends_checks() const { return true; }
  /// Whether q is valid in the space that this one relaxes, or, where it relaxes none, in this one: what is not valid
  /// there is of no use here.
  [[nodiscard]] virtual bool needed(View q) { return state(q); }
  /// What is touched at q; none where nothing is, or where validity is not decided by collisions.
  [[nodiscard]] virtual std::optional<Contact> contact(View q) {
    static_cast<void>(q);
    return {};
  }
  /// Grows each time what is valid may have changed, so that planners look again at what they had checked.
  [[nodiscard]] virtual std::uint64_t epoch() const { return 0; }
  /// Whether the motion, valid at an earlier epoch, still is. Costs no validity check where what became invalid is
  /// known by itself; by default the motion is checked anew (`motion`).
  [[nodiscard]] virtual MotionReport motion_still_valid(View a, View b) { return motion(a, b); }
  /// Factor on the cost of an edge for searches of roadmaps, >= 1: more where validating it would cost checks still.
  [[nodiscard]] virtual double effort_factor(View a, View b) const {
    static_cast<void>(a);
    static_cast<void>(b);
    return 1.0;
  }
  /// Where on the motion from a to b, in [0, 1], it enters a place that was excluded as a whole; none where it does
  /// not. Costs no check.
  [[nodiscard]] virtual std::optional<double> excluded(View a, View b) {
    static_cast<void>(a);
    static_cast<void>(b);
    return std::nullopt;
  }
  /// Told whether the motions that follow go towards a guided proposal, so that they are likely to be on the path
  /// found.
  virtual void expect_guided(bool guided) { static_cast<void>(guided); }
  /// A lower bound on the distance in the metric from q, invalid, to the nearest valid configuration; 0 where it is not
  /// known.
  [[nodiscard]] virtual double invalid_radius(View q) {
    static_cast<void>(q);
    return 0.0;
  }
};

/// Validity by a collision checker.
class CollisionValidity final : public Validity {
 public:
  explicit CollisionValidity(std::unique_ptr<Checker> checker) : checker_(std::move(checker)) {}
  [[nodiscard]] bool state(View q) override { return checker_->valid(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override { return checker_->motion(a, b); }
  [[nodiscard]] double clearance(View q) override { return checker_->clearance(q); }
  [[nodiscard]] std::optional<Contact> contact(View q) override { return checker_->contact(q); }
  [[nodiscard]] double invalid_radius(View q) override { return checker_->invalid_radius(q); }
  [[nodiscard]] const Checker& checker() const { return *checker_; }

 private:
  std::unique_ptr<Checker> checker_;
};

/// An explicit graph in a space: an instance that has one is searched exactly.
struct Graph {
  struct Edge {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    double cost = 0.0;
    Configurations points;  ///< the edge's polyline, both ends included; empty: straight
  };
  Configurations vertices;
  std::vector<Edge> edges;  ///< undirected
  std::uint32_t start = 0;  ///< vertices
  std::uint32_t goal = 0;
  bool verified = true;  ///< its edges are known to be valid; else the search looks at those that it goes along
};

/// Checks spent, in total or by one level.
struct Checks {
  std::uint64_t validity = 0;  ///< configurations whose validity was decided, those on motions included
  std::uint64_t motion = 0;    ///< motions checked
};

/// A motion planning instance (C, validity, s, t, motion model): what a planner solves and what a guide projects.
class Instance {
 public:
  Space space;
  std::shared_ptr<const Scene> scene;  ///< world and robot, for guides that look at geometry
  std::shared_ptr<Validity> validity;
  std::shared_ptr<Graph> graph;  ///< nullptr: a sampling planner searches the space
  Configuration start;
  Configuration goal;            ///< what guides and figures go by
  Configurations further_goals;  ///< each of them would do as well; none of most instances
  double goal_tolerance = 1e-6;
  double resolution = 0.05;
  double shared_resolution = 0.0;  ///< of C, where motions of this space are checked there too; 0: they are not
  /// What the reference point's path keeps from all obstacles, metres, at least, in every solution of the instances
  /// that this one was projected from: a path in this space that does not helps none of them.
  double needed_clearance = 0.0;
  /// How far from the reference point a robot reaches that is to follow what is found here, metres: of a space that
  /// this one relaxes.
  double needed_reach = 0.0;
  std::string collision = "planar";
  double step = 0.0;  ///< longest extension of the planner that searches it, metres in the metric; 0: it has none
  std::shared_ptr<const MotionModel> motion_model;  ///< nullptr: straight motions; else the space holds its states
  std::vector<std::size_t> position_axes;           ///< axes that hold the reference point's position; empty: none
  /// Makes validity for a scene where the axes are not the robot's; empty where they are.
  std::function<std::shared_ptr<Validity>(const std::shared_ptr<const Scene>&)> validity_of;

  /// Validity checks of a motion one metre long.
  [[nodiscard]] double checks_per_metre() const {
    return 1.0 / resolution + (shared_resolution > 0.0 ? 1.0 / shared_resolution : 0.0);
  }
  [[nodiscard]] std::size_t goals() const { return 1 + further_goals.size(); }
  /// `goal` first, then the further ones.
  [[nodiscard]] View goal_at(std::size_t i) const { return i == 0 ? View(goal) : further_goals[i - 1]; }
  struct NearGoal {
    std::size_t goal = 0;  ///< of goal_at
    double distance = 0.0;
  };
  [[nodiscard]] NearGoal nearest_goal(View q) const;
  /// How far the nearest goal is from q.
  [[nodiscard]] double to_goal(View q) const { return nearest_goal(q).distance; }

  /// Counted validity.
  [[nodiscard]] bool valid(View q) {
    if (validity->spends_checks()) ++checks.validity;
    return validity->state(q);
  }
  /// Whether the motion was verified since the instance changed last.
  [[nodiscard]] bool is_verified(View a, View b) const {
    return verified && verified->epoch() == epoch() && verified->contain(a, b);
  }
  /// Counted, unless the motion was verified before.
  [[nodiscard]] MotionReport motion(View a, View b) {
    if (is_verified(a, b)) return {true, 0, std::numeric_limits<double>::quiet_NaN()};
    const MotionReport report = validity->motion(a, b);
    if (validity->spends_checks()) {
      checks.validity += report.checks;
      ++checks.motion;
    }
    return report;
  }
  /// Counted: whether a motion that was valid at an earlier epoch still is.
  [[nodiscard]] MotionReport recheck_motion(View a, View b) {
    const MotionReport report = validity->motion_still_valid(a, b);
    if (validity->spends_checks() && report.checks > 0) {
      checks.validity += report.checks;
      ++checks.motion;
    }
    return report;
  }
  [[nodiscard]] bool motion_still_valid(View a, View b) { return recheck_motion(a, b).valid; }
  /// Drives from a valid state under a control for so many steps, as far as that is valid: appends the state after each
  /// valid step. Each step counts as a motion. \param blocked  if not null: receives the first state found invalid
  /// \return the steps driven. Needs a motion model.
  std::uint32_t drive(View from, View control, std::uint32_t steps, Configurations& states,
                      Configuration* blocked = nullptr);

  /// Validity in this space with another scene's world and robot, checked for real whatever is presumed here.
  [[nodiscard]] std::shared_ptr<Validity> validity_in(const std::shared_ptr<const Scene>& other) const;

  /// Counted as the validity check that it is at least.
  [[nodiscard]] double clearance(View q) {
    if (validity->spends_checks()) ++checks.validity;
    return validity->clearance(q);
  }

  /// Grows each time that what is valid may have changed: by itself, or because the instance was projected anew.
  [[nodiscard]] std::uint64_t epoch() const { return revision + validity->epoch(); }

  Checks checks;
  std::shared_ptr<VerifiedMotions> verified;  ///< motions known to be valid; nullptr: none
  std::uint64_t revision = 0;                 ///< grows when the instance is replaced by a new projection
};

/// Validity by collision checks, and where there is a motion model by its limits and the bounds of its states.
std::shared_ptr<Validity> make_validity(const std::string& collision, const std::shared_ptr<const Scene>& scene,
                                        const Space& space, double resolution,
                                        const std::shared_ptr<const MotionModel>& motion_model);

/// The instance of a problem in the configuration space of the real robot. Does not validate the problem.
std::unique_ptr<Instance> make_instance(const Problem& problem);

}  // namespace trellis
