// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/base/random.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/planner/density.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// The result of extending towards a proposal.
enum class Fate : std::uint8_t {
  rejected,  ///< no node added: the motion was blocked at once, or the proposal was invalid or out of reach
  advanced,  ///< a node was added between the tree and the proposal
  reached,   ///< a node was added at the proposal itself
};

/// The tree that a bidirectional planner grows: from the start, or from the goal.
enum class TreeSide : std::uint8_t { start, goal };

/// Denotes no row of Search::nodes.
inline constexpr std::uint32_t no_node = std::numeric_limits<std::uint32_t>::max();

/// The result of one proposal, or of a motion that the planner tried without a proposal, in the planner's space. The
/// views are valid during the call only.
struct Outcome {
  Fate fate = Fate::rejected;
  View proposal;
  View near;        ///< node that the extension started from; empty if none
  View added;       ///< node that was added; empty if rejected
  View blocked_at;  ///< first configuration found invalid; empty if none
  /// Whether the extension belongs to the tree from the goal (RRT-Connect).
  bool from_goal = false;
  /// Whether checked motions connect `added` to the start (if `from_goal`: to the goal). False for some vertices of
  /// roadmaps; the planner reports such a vertex again, without a proposal, once it is connected.
  bool connected = true;
  std::uint32_t added_row = no_node;  ///< of `added` in Search::nodes
  std::uint32_t near_row = no_node;   ///< of `near`; no_node where the planner does not report it
  View control;                       ///< under which `near` was driven; empty without a motion model, or on a curve
  std::uint32_t steps = 0;            ///< of the motion model, for which the motion under `control` is valid
};

/// An extension of which h may choose the control.
struct ControlQuery {
  View from;                    ///< the node that is extended
  std::uint32_t row = no_node;  ///< of the node in Search::nodes
  View proposal;                ///< the last proposal
  std::uint32_t longest = 1;    ///< longest duration, in steps of the motion model
};

/// The heuristic h as a planner sees it: it hears what became of each proposal, and answers what a planner may ask
/// about the last one. A planner cannot draw from it. Views have the dimension of the planner's space, which is not
/// checked.
class Advice {
 public:
  virtual ~Advice() = default;

  /// Receives the result of a sample.
  /// \param outcome  its views are valid during the call only
  /// \param mine  whether this guidance drew the sample. A part of a mixture also receives the results of the other
  ///     parts, because each of them can use a configuration found invalid.
  virtual void observe(const Outcome& outcome, bool mine) {
    static_cast<void>(outcome);
    static_cast<void>(mine);
  }
  /// The node to extend from towards the last proposal, a row of Search::nodes; no_node for the nearest node. Planners
  /// that choose the node themselves do not call this.
  [[nodiscard]] virtual std::uint32_t vertex() const { return no_node; }
  /// Chooses the control of the extension of a node towards the last proposal. Planners with a motion model call this
  /// once for each proposal.
  /// \param stream  of the level; all random numbers of the draw come from it
  /// \param query  its views are valid during the call only
  /// \param control  receives a number for each control of the model, each within its bounds
  /// \return the duration in steps of the model, from 1 to `longest`; 0: the planner chooses the control itself
  virtual std::uint32_t draw_control(Stream& stream, const ControlQuery& query, MutableView control) {
    static_cast<void>(stream);
    static_cast<void>(query);
    static_cast<void>(control);
    return 0;
  }
  /// Whether to check a motion beyond the last proposal: RRT's motion to the goal, or RRT-Connect's motion between the
  /// trees. False where evidence of h refutes the motion: it saves its checks.
  /// \param from  a node
  /// \param to  the goal, or a node of the other tree
  [[nodiscard]] virtual bool worth_connecting(View from, View to) const {
    static_cast<void>(from);
    static_cast<void>(to);
    return true;
  }
  /// Factor >= 1 on the cost of an edge in a roadmap search. It is larger for an edge that leaves the guiding paths.
  /// None: no path weighs edges now, and those of other parts of h decide.
  /// \param a, b  the ends of the edge
  [[nodiscard]] virtual std::optional<double> edge_factor(View a, View b) const {
    static_cast<void>(a);
    static_cast<void>(b);
    return 1.0;
  }
  /// Called after the planner removed nodes. The planner then reports each remaining node again, without a proposal.
  virtual void restart() {}
  /// Called when the planner finds a first or a shorter path from start to goal.
  /// \param length  of the path, in metres in the metric
  virtual void found(double length) { static_cast<void>(length); }
};

/// The heuristic h: a distribution over a planner's space that receives the results of its samples. Who runs the steps
/// of the planner draws from it (Planner::solve, the executor).
class Guidance : public Advice {
 public:
  /// The part that drew a sample: an index into sources(), whose length is constant.
  using Source = std::uint16_t;

  /// Selects the tree that the next proposal is for. A bidirectional planner calls this before each `sample`; other
  /// planners grow one tree, from the start.
  virtual void select_tree(TreeSide side) { static_cast<void>(side); }
  /// Draws a proposal.
  /// \param stream  of the level that calls; all random numbers of the draw come from it
  /// \param out  receives the proposal, inside the space; it may be invalid
  /// \return the part that drew it
  virtual Source sample(Stream& stream, MutableView out) = 0;
  /// Draws what `sample` would draw now, if that depends on the stream alone: not on results of earlier samples.
  /// \param stream  a copy of the level's, which is advanced as `sample` advances it
  /// \param out  receives the proposal
  /// \return whether it does; else `out` is unspecified
  [[nodiscard]] virtual bool preview(Stream& stream, MutableView out) const {
    static_cast<void>(stream);
    static_cast<void>(out);
    return false;
  }
  /// Length along the guiding paths by which connected nodes advanced during the whole run, in metres in the metric.
  [[nodiscard]] virtual double progress() const { return 0.0; }
  /// Length along the guiding paths that connected nodes cover now, in metres in the metric. Removal of nodes reduces
  /// it.
  [[nodiscard]] virtual double connected() const { return 0.0; }
  /// Adds the distribution of the next sample to the record, with weight `share`. By default, as a part without closed
  /// form. A sequence of guides changes its active guide when it draws: it adds the distribution of the last sample.
  /// \param record  of the search; receives the distribution
  /// \param share  in (0, 1]: of this part in the distribution of the whole
  virtual void record(DensityRecord& record, double share) const { record.add_unknown(share); }
  /// A counter that increases when `sample` or `observe` may have changed what `record` adds.
  [[nodiscard]] virtual std::uint64_t epoch() const { return 0; }
  /// The names of the parts that draw samples.
  [[nodiscard]] virtual std::vector<std::string> sources() const = 0;
};

/// The lesser of two edge factors of which either may be none.
/// \param a, b  none where no path weighs the edge
inline std::optional<double> least_factor(std::optional<double> a, std::optional<double> b) {
  return a && b ? std::min(*a, *b) : a ? a : b;
}

/// Uniform distribution over the space; S = {0}.
class UniformGuidance final : public Guidance {
 public:
  /// \param space  of the planner
  explicit UniformGuidance(Space space) : space_(std::move(space)), density_(std::exp(-space_.log_volume())) {}
  Source sample(Stream& stream, MutableView out) override {
    space_.sample_uniform(stream, out);
    return 0;
  }
  [[nodiscard]] bool preview(Stream& stream, MutableView out) const override {
    space_.sample_uniform(stream, out);
    return true;
  }
  void record(DensityRecord& record, double share) const override { record.add_uniform(share, density_); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"uniform"}; }

 private:
  Space space_;
  double density_;
};

/// The goal, or one of several goals; S = {0}. Its distribution has atoms and no density.
class GoalGuidance final : public Guidance {
 public:
  /// \param instance  with at least one goal; its goals are copied
  explicit GoalGuidance(const Instance& instance) : goals_(instance.space.dimension()) {
    for (const auto& goal : instance.goals) goals_.push(goal);
  }
  Source sample(Stream& stream, MutableView out) override {
    draw(stream, out);
    return 0;
  }
  [[nodiscard]] bool preview(Stream& stream, MutableView out) const override {
    draw(stream, out);
    return true;
  }
  void record(DensityRecord& record, double share) const override { record.add_atoms(share); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"goal"}; }

 private:
  void draw(Stream& stream, MutableView out) const {
    const View goal = goals_[goals_.size() > 1 ? stream.below(goals_.size()) : 0];
    std::copy(goal.begin(), goal.end(), out.begin());
  }

  Configurations goals_;
};

inline void DensityRecord::served(const Guidance& h) {
  if (!enabled_) return;
  if (h.epoch() != epoch_) [[unlikely]]
    renew(h);
  served_ += 1.0;
}

}  // namespace trellis
