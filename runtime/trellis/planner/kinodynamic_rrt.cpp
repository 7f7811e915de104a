// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/motion/steering.hpp>
#include <trellis/planner/tree_planner.hpp>

namespace trellis {

namespace {

struct KinodynamicRrtSettings : CommonSettings {
  std::int64_t controls = 10;
  double longest = 1.0;
  double connect = 1.0;
  bool curves = false;
};

const Settings<KinodynamicRrtSettings>& kinodynamic_rrt_settings() {
  static const Settings<KinodynamicRrtSettings> settings = with_common(
      Settings<KinodynamicRrtSettings>(
          Component::Kind::planner, "kinodynamic_rrt",
          "rapidly-exploring random tree that drives the problem's motion model: from the node nearest to a proposal, "
          "under the one of several random controls that comes nearest to it",
          "LaValle and Kuffner 2001, Randomized kinodynamic planning")
          .integer(
              "controls", &KinodynamicRrtSettings::controls, "controls", Range::at_least(1),
              "random controls, each for a random duration, that are tried for a proposal before one is checked; a "
              "guide may choose the control of a proposal that it drew, and then none is")
          .number("longest", &KinodynamicRrtSettings::longest, "s", Range::positive(),
                  "the longest duration of a control, or of an extension along a curve; a whole number of the model's "
                  "steps, at least one")
          .choice("extend", &KinodynamicRrtSettings::curves, {{"controls", false}, {"curves", true}},
                  "how a node is driven towards a proposal: \"controls\", under random controls; \"curves\", along the "
                  "shortest curve to it at a random speed, of Dubins, or of Reeds and Shepp where the model can go "
                  "backwards: unicycle1 and car have them, any other model keeps to controls")
          .number("connect", &KinodynamicRrtSettings::connect, "m in the metric", Range::non_negative(),
                  "from new nodes this near to the goal the shortest curve to it is tried, of Dubins, or of Reeds and "
                  "Shepp where the model can go backwards: with unicycle1 and car only; 0: never"));
  return settings;
}

class KinodynamicRrt final : public StartTreePlanner {
 public:
  KinodynamicRrt(const KinodynamicRrtSettings& settings, PlannerContext context)
      : StartTreePlanner(std::move(context)),
        settings_(settings),
        curves_(settings.curves),
        model_holder_(context_.instance.motion_model),
        model_(*model_holder_),
        steering_work_(steering_work(model_)),
        most_steps_(steps_of(settings.longest, model_.dt())),
        state_(dimension()),
        control_(model_.controls().size()),
        best_control_(model_.controls().size()) {
    ControlRecord& record = context_.search.controls;
    if (record.longest == 0) record.controls = Configurations(model_.controls().size());
    record.longest = static_cast<std::uint32_t>(most_steps_);
    record.curves = curves_;
    record.dt = model_.dt();
  }

  Outcome extend(View proposal) override {
    const auto near = tree_->to_extend(proposal);
    const View node = (*tree_)[near.id];
    from_.assign(node.begin(), node.end());
    towards_ = trajectory_from(from_, tree_->row(near.id), proposal);
    driven_ = drive(from_, towards_, most_steps_);
    record_controls(towards_, driven_);
    Outcome outcome;
    if (towards_.steps.size() == 1) {
      outcome.control = std::as_const(towards_.controls).front();
      outcome.steps = driven_.ends.empty() ? 0 : driven_.ends.back();
    }
    outcome.proposal = proposal;
    outcome.near = from_;
    outcome.near_row = tree_->row(near.id);
    outcome.blocked_at = driven_.blocked;
    added_ = no_node;
    if (driven_.ends.empty()) return outcome;
    added_ = add(near.id, driven_, towards_);
    outcome.added = std::as_const(driven_.states)[driven_.ends.back() - 1];
    outcome.added_row = tree_->row(added_);
    const double left = context_.instance.space.distance(outcome.added, proposal);
    outcome.fate = left == 0.0 ? Fate::reached : Fate::advanced;
    proposal_ = proposal;
    return outcome;
  }
  std::optional<Status> follow() override {
    if (added_ != no_node) {
      report_pieces(driven_, added_, driven_.ends.size() - 1, proposal_);
      const View added = std::as_const(driven_.states)[driven_.ends.back() - 1];
      if (!solved_ && context_.instance.to_goal(added) <= settings_.connect) connect(added_, added);
    }
    return ended();
  }

 protected:
  void plant() override {
    edges_.assign(1, {});
    controls_ = Configurations(model_.controls().size());
    StartTreePlanner::plant();
  }

  void pruned(const std::vector<std::uint32_t>& ids) override {
    std::vector<Edge> kept(tree_->size());
    for (std::uint32_t id = 0; id < ids.size(); ++id) {
      if (ids[id] != no_node) kept[ids[id]] = edges_[id];
    }
    edges_ = std::move(kept);
  }

  /// Checks each step of the motion.
  bool edge_still_valid(std::uint32_t id) override {
    const Edge& edge = edges_[id];
    const View from = (*tree_)[tree_->parent(id)];
    std::copy(from.begin(), from.end(), state_.begin());
    Configuration next(dimension());
    for (std::uint32_t k = 0; k < edge.steps; ++k) {
      context_.instance.spend(model_.step_work());
      model_.step(context_.instance.space, state_, std::as_const(controls_)[edge.control], next);
      if (!motion_still_valid(context_, state_, next, repair_->since())) return false;
      std::swap(state_, next);
    }
    return true;
  }

  [[nodiscard]] Solution finish(Status status) const override { return to_node(status, best_); }
  [[nodiscard]] Solution unrepaired(Status status) const override { return to_node(status, 0); }

 private:
  /// Returns the number of integration steps of the longest motion.
  static std::size_t steps_of(double longest, double dt) {
    constexpr double most = 10000.0;
    const double steps = std::floor(longest / dt + 1e-9);
    if (!(steps <= most)) {
      throw Error(
          fmt::format("kinodynamic_rrt: longest = {:g} s takes {:g} steps of the motion model's dt = {:g} s, at "
                      "most {:g}; increase dt or decrease longest",
                      longest, steps, dt, most));
    }
    return static_cast<std::size_t>(std::max(steps, 1.0));
  }

  /// The motion to a node from its parent.
  struct Edge {
    std::uint32_t control = 0;  ///< row of `controls_`
    std::uint32_t steps = 0;
  };

  /// Samples controls and durations, and returns the control whose end state is nearest to the proposal. Makes no
  /// validity check.
  std::uint32_t choose_control(View from, View proposal) {
    const auto& space = context_.instance.space;
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t chosen = 0;
    for (std::int64_t i = 0; i < settings_.controls; ++i) {
      model_.sample_control(context_.proposals, control_);
      const auto steps = static_cast<std::uint32_t>(1 + context_.proposals.below(most_steps_));
      context_.instance.spend(model_.step_work() * static_cast<double>(steps));
      std::copy(from.begin(), from.end(), state_.begin());
      for (std::uint32_t k = 0; k < steps; ++k) model_.step(space, state_, control_, state_);
      const double distance = space.squared_distance(state_, proposal);
      if (distance >= least) continue;
      least = distance;
      chosen = steps;
      best_control_ = control_;
    }
    return chosen;
  }

  /// The valid part of a driven trajectory: its states, and the index of the last state of each piece.
  struct Driven {
    Configurations states;
    std::vector<std::uint32_t> ends;
    bool arrived = false;  ///< the last state is at the goal
    Configuration blocked;
  };

  /// Drives a trajectory until it is invalid, reaches the goal, or has taken `most` steps.
  Driven drive(View from, const Trajectory& trajectory, std::size_t most) {
    auto& instance = context_.instance;
    Driven driven{Configurations(dimension()), {}, false, {}};
    Configuration at(from.begin(), from.end());
    for (std::size_t i = 0; i < trajectory.steps.size() && !driven.arrived && driven.states.size() < most; ++i) {
      const std::size_t before = driven.states.size();
      const auto wanted = static_cast<std::uint32_t>(std::min<std::size_t>(trajectory.steps[i], most - before));
      const auto done = instance.drive(at, trajectory.controls[i], wanted, driven.states, &driven.blocked);
      std::size_t end = before;
      while (end < before + done && !driven.arrived) {
        const View state = std::as_const(driven.states)[end++];
        driven.arrived = instance.to_goal(state) <= instance.goal_tolerance;
      }
      if (end == before) break;
      driven.ends.push_back(static_cast<std::uint32_t>(end));
      at.assign(std::as_const(driven.states)[end - 1].begin(), std::as_const(driven.states)[end - 1].end());
      if (done < wanted) break;
    }
    if (driven.arrived) driven.blocked.clear();
    return driven;
  }

  /// Adds the end states of the pieces to the tree as descendants of a node; returns the last one.
  std::uint32_t add(std::uint32_t parent, const Driven& driven, const Trajectory& trajectory) {
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < driven.ends.size(); ++i) {
      const std::uint32_t node = tree_->add(driven.states[driven.ends[i] - 1], parent);
      edges_.push_back({controls_.push(trajectory.controls[i]), driven.ends[i] - before});
      note(node);
      before = driven.ends[i];
      parent = node;
    }
    return parent;
  }

  /// Records the controls of a motion towards the proposal.
  void record_controls(const Trajectory& trajectory, const Driven& driven) const {
    ControlRecord& record = context_.search.controls;
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < trajectory.steps.size(); ++i) {
      record.controls.push(trajectory.controls[i]);
      record.steps.push_back(trajectory.steps[i]);
      const std::uint32_t end = i < driven.ends.size() ? driven.ends[i] : before;
      record.driven.push_back(end - std::exchange(before, end));
    }
    record.ends.push_back(static_cast<std::uint32_t>(record.steps.size()));
  }

  /// The trajectory from a node towards the proposal: under the control that the guidance draws, along a curve, or
  /// under a random control.
  Trajectory trajectory_from(View from, std::uint32_t row, View proposal) {
    const auto longest = static_cast<std::uint32_t>(most_steps_);
    if (const std::uint32_t steps =
            context_.guidance.draw_control(context_.proposals, {from, row, proposal, longest}, control_)) {
      if (steps > longest || !model_.allows(control_)) throw Fault("a guide drew a control out of its bounds");
      Trajectory trajectory{Configurations(model_.controls().size()), {steps}, model_.dt()};
      trajectory.controls.push(control_);
      return trajectory;
    }
    if (curves_) {
      context_.instance.spend(steering_work_);
      auto curve = steer_at(model_, from, proposal, context_.proposals.uniform());
      if (curve && !curve->steps.empty()) return std::move(*curve);
    }
    Trajectory trajectory{Configurations(model_.controls().size()), {choose_control(from, proposal)}, model_.dt()};
    trajectory.controls.push(best_control_);
    return trajectory;
  }

  /// Reports the nodes of the first pieces of a motion, without a proposal.
  /// \param last  the motion's last node
  void report_pieces(const Driven& driven, std::uint32_t last, std::size_t pieces, View towards) {
    for (std::size_t i = 0; i < pieces; ++i) {
      Outcome outcome;
      outcome.fate = Fate::advanced;
      outcome.proposal = towards;
      outcome.added = std::as_const(driven.states)[driven.ends[i] - 1];
      const auto id = last - static_cast<std::uint32_t>(driven.ends.size() - 1 - i);
      outcome.near = (*tree_)[tree_->parent(id)];
      outcome.near_row = tree_->row(tree_->parent(id));
      outcome.added_row = tree_->row(id);
      context_.guidance.observe(outcome, false);
    }
  }

  /// Drives the shortest curve from a node to the goal. Adds it to the tree if it arrives.
  void connect(std::uint32_t id, View from) {
    const View goal = context_.instance.goals[context_.instance.nearest_goal(from).goal];
    if (!context_.guidance.worth_connecting(from, goal)) return;
    const auto arrives = [&](const std::optional<Trajectory>& trajectory) {
      if (!trajectory) return false;
      const Driven driven = drive(from, *trajectory, std::numeric_limits<std::size_t>::max());
      if (driven.arrived) {
        report_pieces(driven, add(id, driven, *trajectory), driven.ends.size(), goal);
      } else if (!driven.blocked.empty()) {
        Outcome outcome;
        outcome.proposal = goal;
        outcome.near = from;
        outcome.blocked_at = driven.blocked;
        context_.guidance.observe(outcome, false);
      }
      return driven.arrived;
    };
    context_.instance.spend(steering_work_);
    if (!arrives(steer(model_, from, goal)) && curves_) {
      context_.instance.spend(steering_work_);
      arrives(steer_at(model_, from, goal, context_.proposals.uniform()));
    }
  }

  /// The solution that ends at a node.
  [[nodiscard]] Solution to_node(Status status, std::uint32_t end) const {
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t at = end; at != 0; at = tree_->parent(at)) nodes.push_back(at);
    Solution solution{status, {}, {Configurations(controls_.dimension()), {}, model_.dt()}};
    solution.trajectory.steps.reserve(nodes.size());
    for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) {
      solution.trajectory.controls.push(controls_[edges_[*it].control]);
      solution.trajectory.steps.push_back(edges_[*it].steps);
    }
    const auto& instance = context_.instance;
    solution.path = replay(model_, instance.space, instance.start, solution.trajectory);
    return solution;
  }

  KinodynamicRrtSettings settings_;
  bool curves_;                                      ///< a node is driven along curves, where the model has them
  std::shared_ptr<const MotionModel> model_holder_;  ///< outlives a replaced instance
  const MotionModel& model_;
  double steering_work_;     ///< of a curve
  std::size_t most_steps_;   ///< longest duration of a control, in steps
  std::vector<Edge> edges_;  ///< of each node; unused for the root
  // Of the last proposal:
  View proposal_;
  Configuration from_;             ///< the node that was extended
  Trajectory towards_;             ///< as chosen
  Driven driven_;                  ///< its valid part
  std::uint32_t added_ = no_node;  ///< the last node of that
  Configurations controls_;
  Configuration state_;
  Configuration control_;
  Configuration best_control_;
};

}  // namespace

PlannerKind kinodynamic_rrt_kind() {
  PlannerKind kind;
  kind.component = &kinodynamic_rrt_settings().component();
  kind.common = [](const Options& o) { return common_of(kinodynamic_rrt_settings().read(o)); };
  kind.make = [](const Options& o, PlannerContext context) -> std::unique_ptr<Planner> {
    if (!context.instance.motion_model) throw Fault("kinodynamic_rrt needs an instance with a motion model");
    return std::make_unique<KinodynamicRrt>(kinodynamic_rrt_settings().read(o), std::move(context));
  };
  kind.kinodynamic = true;
  return kind;
}

}  // namespace trellis
