// SPDX-License-Identifier: GPL-3.0-or-later
// What asymptotically optimal planners share: their options, and the shortest path known while they go on.
#pragma once

#include <limits>
#include <string>
#include <utility>

#include <trellis/planner/connection.hpp>
#include <trellis/planner/loop.hpp>

namespace trellis {

/// `with_anytime` describes these fields.
struct AnytimeSettings : CommonSettings {
  std::string connect = "k_nearest";
  double factor = 1.1;
  double improve = 1000;

  [[nodiscard]] Connection connection(const Space& space) const {
    return connect == "within" ? Connection::within(space, factor) : Connection::k_nearest(space, factor);
  }
};

template <class S>
Settings<S> with_anytime(Settings<S> settings) {
  settings
      .choice(
          "connect", &S::connect, {"k_nearest", "within"},
          "what a new node may be joined to, n nodes in d dimensions: \"k_nearest\", the e (1 + 1/d) log n nearest; "
          "\"within\", all within 2 ((1 + 1/d) |C| log n / (n zeta_d))^(1/d), zeta_d the volume of the unit ball")
      .number("factor", &S::factor, "times", Range::positive(),
              "by what that number or that radius is multiplied; the proofs ask for more than 1")
      .number("improve", &S::improve, "proposals", Range::at_least(0),
              "proposals spent on shorter paths once one is known, in each solve, within the budget");
  return with_common(std::move(settings));
}

/// The shortest path known to a planner that goes on when it has one.
class BestPath {
 public:
  /// \param improve  proposals of a solve after the first path, or from its beginning where one is known
  BestPath(Planner::Task& task, double improve)
      : task_(task), improve_(improve), straight_(task.instance.to_goal(task.instance.start)) {}

  /// A solve begins.
  void begin() {
    begun_ = from_ = drawn();
    kept_ = false;
  }
  /// What was valid may not be so any more.
  void forget() {
    length_ = std::numeric_limits<double>::infinity();
    straight_ = task_.instance.to_goal(task_.instance.start);
  }
  /// A path shorter than the one known: h is told of it.
  void keep(Configurations path) {
    if (!known()) from_ = drawn();
    path_ = std::move(path);
    length_ = path_length(task_.instance.space, path_);
    kept_ = true;
    task_.guidance.found(length_);
  }

  [[nodiscard]] bool known() const { return length_ < std::numeric_limits<double>::infinity(); }
  /// Whether to stop: all was spent on a shorter one that was to be, or there is none.
  [[nodiscard]] bool done() const {
    return known() && (drawn() - from_ >= improve_ || length_ <= straight_ * (1.0 + 1e-12));
  }
  /// As the solve's solution, for whatever reason it ends. One that could do nothing has found nothing.
  [[nodiscard]] Solution solution(Status reason) const {
    const bool spent_nothing = !kept_ && drawn() == begun_;
    return {reason == Status::budget_spent && !spent_nothing ? Status::solved : reason, path_};
  }

 private:
  [[nodiscard]] double drawn() const { return static_cast<double>(task_.search.proposals.size()); }

  Planner::Task& task_;
  double improve_;
  double straight_;
  double length_ = std::numeric_limits<double>::infinity();
  Configurations path_;
  double from_ = 0.0;   ///< proposals drawn when improving began
  double begun_ = 0.0;  ///< proposals drawn when the solve began
  bool kept_ = false;   ///< in this solve
};

}  // namespace trellis
