// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by the asymptotically optimal (anytime) planners: their options, and the shortest path found so far.
#pragma once

#include <limits>
#include <string>
#include <utility>

#include <trellis/planner/common.hpp>
#include <trellis/planner/connection.hpp>

namespace trellis {

/// The options of anytime planners. `with_anytime` describes each field.
struct AnytimeSettings : CommonSettings {
  bool within = false;
  double factor = 1.1;
  double improve = 1000;

  [[nodiscard]] Connection connection(const Space& space) const {
    return within ? Connection::within(space, factor) : Connection::k_nearest(space, factor);
  }
};

template <class S>
Settings<S> with_anytime(Settings<S> settings) {
  settings
      .choice(
          "connect", &S::within, {{"k_nearest", false}, {"within", true}},
          "what a new node may be joined to, n nodes in d dimensions: \"k_nearest\", the e (1 + 1/d) log n nearest; "
          "\"within\", all within 2 ((1 + 1/d) |C| log n / (n zeta_d))^(1/d), zeta_d the volume of the unit ball")
      .number("factor", &S::factor, "times", Range::positive(),
              "by what that number or that radius is multiplied; the proofs ask for more than 1")
      .number("improve", &S::improve, "proposals", Range::at_least(0),
              "proposals spent on shorter paths once one is known, in each solve, within the budget");
  return with_common(std::move(settings));
}

/// The shortest path of an anytime planner. The planner continues to improve it after the first path.
class BestPath {
 public:
  /// \param improve  proposals that a solve spends after it found its first path; if a path is known when the solve
  ///     begins, proposals of the whole solve
  BestPath(PlannerContext& context, double improve)
      : context_(context), improve_(improve), straight_(context.instance.to_goal(context.instance.start)) {}

  /// Begins a solve.
  void begin() {
    begun_ = from_ = drawn();
    kept_ = false;
  }
  /// Discards the path: the instance changed, so the path may be invalid now.
  void forget() {
    length_ = std::numeric_limits<double>::infinity();
    straight_ = context_.instance.to_goal(context_.instance.start);
  }
  /// Stores a path that is shorter than the stored one, and reports its length to the guidance.
  void keep(Configurations path) {
    if (!known()) from_ = drawn();
    path_ = std::move(path);
    length_ = path_length(context_.instance.space, path_);
    kept_ = true;
    context_.guidance.found(length_);
  }

  [[nodiscard]] bool known() const { return length_ < std::numeric_limits<double>::infinity(); }
  /// Whether the solve ends: `improve` proposals are spent, or the path is as short as the straight motion to the goal.
  [[nodiscard]] bool done() const {
    return known() && (drawn() - from_ >= improve_ || length_ <= straight_ * (1.0 + 1e-12));
  }
  /// The solution with which the solve ends.
  /// \param reason  why the solve ends
  /// \return the stored path, with Status::solved if the budget or a pause ended the solve. A solve that drew no
  /// proposal and
  ///     stored no path returns `reason`.
  [[nodiscard]] Solution solution(Status reason) const {
    const bool spent_nothing = !kept_ && drawn() == begun_;
    const bool limited = reason == Status::budget_spent || reason == Status::paused;
    return {limited && !spent_nothing ? Status::solved : reason, path_};
  }

 private:
  [[nodiscard]] double drawn() const { return static_cast<double>(context_.search.proposals.size()); }

  PlannerContext& context_;
  double improve_;
  double straight_;
  double length_ = std::numeric_limits<double>::infinity();
  Configurations path_;
  double from_ = 0.0;   ///< proposals drawn before the improvement began
  double begun_ = 0.0;  ///< proposals drawn before the solve began
  bool kept_ = false;   ///< this solve stored a path
};

}  // namespace trellis
