// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/base/random.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/planner/density.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// What became of a proposal.
enum class Fate : std::uint8_t {
  rejected,  ///< no node: the way to it was blocked at once, or it was invalid or out of reach
  advanced,  ///< a node was added on the way towards it
  reached,   ///< a node was added at the proposal itself
};

/// The tree that a bidirectional planner grows: from the start, or from the goal.
enum class TreeSide : std::uint8_t { start, goal };

/// No row of Search::nodes.
inline constexpr std::uint32_t no_node = std::numeric_limits<std::uint32_t>::max();

/// The planner's answer to one proposal, or news of a motion that it tried of its own accord, in the planner's space.
/// Views hold during the call only.
struct Outcome {
  Fate fate = Fate::rejected;
  View proposal;
  View near;        ///< the node that the extension started from; empty where there was none
  View added;       ///< the node that was added; empty when rejected
  View blocked_at;  ///< the first configuration found invalid; empty where none was
  /// The extension that grew from the goal's side (RRT-Connect), not from the start's.
  bool from_goal = false;
  /// Whether `added` is joined to the start (`from_goal`: to the goal) by motions that were checked. A roadmap's vertex
  /// may not be; it is reported again, by an outcome that no proposal belongs to, when it is.
  bool connected = true;
  std::uint32_t added_row = no_node;  ///< of `added` in Search::nodes
};

/// h as a planner sees it: a distribution over the planner's space with feedback.
class Guidance {
 public:
  /// Which part drew a sample: an index into sources(), which never changes its length.
  using Source = std::uint16_t;

  virtual ~Guidance() = default;

  /// Called by a bidirectional planner before each `sample`: the tree that the proposal is for. The others grow from
  /// the start.
  virtual void select_tree(TreeSide side) { static_cast<void>(side); }
  /// Draws a proposal into `out` (inside the space).
  virtual Source sample(Stream& stream, MutableView out) = 0;
  /// The density at q of the next sample, with respect to volume in metric coordinates; the absolutely continuous part
  /// only. NaN where h has no closed form. A sequence passes the turn on when it draws: then of the last sample.
  [[nodiscard]] virtual double density(View q) const = 0;
  /// The probability that the next sample is exactly one of finitely many points (the goal of a goal bias).
  [[nodiscard]] virtual double atom_mass() const { return 0.0; }
  /// Told after every sample what became of it. `mine`: this guidance drew it; a part of a mixture is also told of the
  /// others' outcomes, because a configuration found invalid is news to all.
  virtual void observe(const Outcome& outcome, bool mine) {
    static_cast<void>(outcome);
    static_cast<void>(mine);
  }
  /// The node that the last proposal is best extended from, a row of Search::nodes; no_node: the nearest one. A planner
  /// that chooses the node itself need not ask.
  [[nodiscard]] virtual std::uint32_t vertex() const { return no_node; }
  /// Whether a motion that a planner would try beyond the last proposal (RRT's to the goal, RRT-Connect's from the one
  /// tree to the other) is worth its validity checks.
  [[nodiscard]] virtual bool worth_connecting(View from, View to) const {
    static_cast<void>(from);
    static_cast<void>(to);
    return true;
  }
  /// Length, in metres of the metric, by which connected nodes advanced along what guides, over the whole run.
  [[nodiscard]] virtual double progress() const { return 0.0; }
  /// Length, in metres of the metric, along which nodes are connected now: what a planner's nodes that are removed
  /// have been worth.
  [[nodiscard]] virtual double connected() const { return 0.0; }
  /// Factor on the cost of an edge that a search of a roadmap may use, >= 1: more where the edge leaves what guides.
  [[nodiscard]] virtual double edge_factor(View a, View b) const {
    static_cast<void>(a);
    static_cast<void>(b);
    return 1.0;
  }
  /// Called when the planner removed nodes: those that are left are reported again, by outcomes that no proposal
  /// belongs to.
  virtual void restart() {}
  /// Told when a path from start to goal was found, or a shorter one: its length in the metric.
  virtual void found(double length) { static_cast<void>(length); }
  /// Grows when the density may have changed, while a sample is drawn or an outcome is observed.
  [[nodiscard]] virtual std::uint64_t epoch() const { return 0; }
  /// Enters into the record what h is now, with a share of it. As a part without closed form unless h says otherwise.
  virtual void record(DensityRecord& record, double share) const { record.add_unknown(share); }
  /// The names of the parts that draw samples, for provenance.
  [[nodiscard]] virtual std::vector<std::string> sources() const = 0;
};

/// Uniform on the space: S = {0}.
class UniformGuidance final : public Guidance {
 public:
  explicit UniformGuidance(Space space) : space_(std::move(space)), density_(std::exp(-space_.log_volume())) {}
  Source sample(Stream& stream, MutableView out) override {
    space_.sample_uniform(stream, out);
    return 0;
  }
  [[nodiscard]] double density(View) const override { return density_; }
  void record(DensityRecord& record, double share) const override { record.add_uniform(share, density_); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"uniform"}; }

 private:
  Space space_;
  double density_;
};

/// The goal itself, or one of several: S = {0}. Atoms, without density.
class GoalGuidance final : public Guidance {
 public:
  explicit GoalGuidance(const Instance& instance) : goals_(instance.space.dimension()) {
    for (std::size_t i = 0; i < instance.goals(); ++i) goals_.push(instance.goal_at(i));
  }
  Source sample(Stream& stream, MutableView out) override {
    const View goal = std::as_const(goals_)[goals_.size() > 1 ? stream.below(goals_.size()) : 0];
    std::copy(goal.begin(), goal.end(), out.begin());
    return 0;
  }
  [[nodiscard]] double density(View) const override { return 0.0; }
  [[nodiscard]] double atom_mass() const override { return 1.0; }
  void record(DensityRecord& record, double share) const override { record.add_atoms(share); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"goal"}; }

 private:
  Configurations goals_;
};

inline void DensityRecord::served(const Guidance& h) {
  if (h.epoch() != epoch_) [[unlikely]]
    renew(h);
  served_ += 1.0;
}

}  // namespace trellis
