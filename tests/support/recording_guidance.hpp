// SPDX-License-Identifier: GPL-3.0-or-later
// A guidance that records everything that a planner reports to it, and a validity that counts its rejections.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/planner/common.hpp>

namespace trellis::test {

/// An outcome with its own copies of the configurations.
struct ReportedOutcome {
  bool mine = false;
  Fate fate = Fate::rejected;
  Configuration proposal;
  Configuration near;
  Configuration added;
  Configuration blocked_at;
  bool from_goal = false;
  bool connected = false;
  std::uint32_t added_row = no_node;
  std::uint32_t near_row = no_node;
  Configuration control;
  std::uint32_t steps = 0;
  std::size_t proposals = 0;  ///< number of proposals before the report
};

/// Uniform with a share of goals. A test can replace its answers to a planner's queries.
class RecordingGuidance final : public Guidance {
 public:
  explicit RecordingGuidance(const Instance& instance, double goal_bias = 0.0)
      : uniform_(instance.space), goal_(instance), goal_bias_(goal_bias) {}

  void select_tree(TreeSide side) override { sides.push_back(side); }
  Source sample(Stream& stream, MutableView out) override {
    ++proposals;
    if (!always.empty()) {
      std::copy(always.begin(), always.end(), out.begin());
      return 1;
    }
    if (stream.uniform() < goal_bias_) return goal_.sample(stream, out);
    uniform_.sample(stream, out);
    return 1;
  }
  void observe(const Outcome& o, bool mine) override {
    const auto copy = [](View q) { return Configuration(q.begin(), q.end()); };
    outcomes.push_back({mine, o.fate, copy(o.proposal), copy(o.near), copy(o.added), copy(o.blocked_at), o.from_goal,
                        o.connected, o.added_row, o.near_row, copy(o.control), o.steps, proposals});
  }
  [[nodiscard]] std::uint32_t vertex() const override { return choose_vertex ? choose_vertex() : no_node; }
  std::uint32_t draw_control(Stream&, const ControlQuery& query, MutableView control) override {
    return choose_control ? choose_control(query, control) : 0;
  }
  [[nodiscard]] bool worth_connecting(View from, View to) const override {
    return !judge_connection || judge_connection(from, to);
  }
  [[nodiscard]] std::optional<double> edge_factor(View a, View b) const override {
    return weigh_edge ? weigh_edge(a, b) : std::optional(1.0);
  }
  void found(double length) override { lengths.push_back(length); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"goal", "uniform"}; }

  std::vector<ReportedOutcome> outcomes;
  std::vector<TreeSide> sides;
  std::vector<double> lengths;
  std::size_t proposals = 0;
  std::function<std::uint32_t()> choose_vertex;
  std::function<std::uint32_t(const ControlQuery&, MutableView)> choose_control;
  std::function<bool(View, View)> judge_connection;
  std::function<std::optional<double>(View, View)> weigh_edge;
  Configuration always;  ///< if not empty: every proposal

 private:
  UniformGuidance uniform_;
  GoalGuidance goal_;
  double goal_bias_;
};

/// Validity with a region that a test makes invalid; by its flags it costs no checks, always or for repairs.
class ChangingValidity final : public Validity {
 public:
  explicit ChangingValidity(std::shared_ptr<Validity> inner) : inner_(std::move(inner)) {}

  [[nodiscard]] bool state(View q) override {
    const bool valid = !excluded(q) && inner_->state(q);
    invalid_states += valid ? 0 : 1;
    return valid;
  }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    MotionReport report = enters(a, b) ? MotionReport{false, 1, 1.0} : inner_->motion(a, b);
    if (!counted) report.checks = 0;
    invalid_motions += report.valid ? 0 : 1;
    return report;
  }
  [[nodiscard]] MotionReport motion_still_valid(View a, View b, std::uint64_t) override {
    ++asked_again;
    if (!free_repair) return motion(a, b);
    return {!enters(a, b), 0, 1.0};
  }
  [[nodiscard]] double clearance(View q) override { return inner_->clearance(q); }
  [[nodiscard]] bool spends_checks() const override { return counted; }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }

  /// Makes the configurations invalid for which the predicate holds.
  void exclude(std::function<bool(View)> predicate) {
    excluded_ = std::move(predicate);
    ++epoch_;
  }

  bool counted = true;       ///< it spends checks
  bool free_repair = false;  ///< motion_still_valid costs none
  std::size_t invalid_states = 0;
  std::size_t invalid_motions = 0;
  std::size_t asked_again = 0;  ///< calls of motion_still_valid

 private:
  [[nodiscard]] bool excluded(View q) const { return excluded_ && excluded_(q); }
  /// By its end and points 2 % apart.
  [[nodiscard]] bool enters(View a, View b) const {
    if (!excluded_) return false;
    Configuration q(a.size());
    constexpr int pieces = 50;
    for (int i = 0; i <= pieces; ++i) {
      const double t = static_cast<double>(i) / pieces;
      for (std::size_t j = 0; j < q.size(); ++j) q[j] = a[j] + t * (b[j] - a[j]);
      if (excluded_(q)) return true;
    }
    return false;
  }

  std::shared_ptr<Validity> inner_;
  std::function<bool(View)> excluded_;
  std::uint64_t epoch_ = 0;
};

/// A planner with its instance and guidance, on a problem.
class PlannerRun {
 public:
  PlannerRun(const std::string& planner, const Problem& problem, std::uint64_t seed,
             const std::vector<Options::Entry>& given = {})
      : kind(*find_planner(planner)),
        options(Options::validate(*kind.component, given)),
        instance(make_instance(problem)),
        validity(std::make_shared<ChangingValidity>(instance->validity)),
        guidance(*instance, kind.common(options).goal_bias),
        search(instance->space.dimension()),
        seed_(seed) {
    instance->validity = validity;
  }

  Solution solve() {
    if (!planner_) {
      planner_ = kind.make(options, {*instance, guidance, Stream(seed_, "0", "proposals"), search, guided});
    }
    return planner_->solve(guidance, kind.common(options).budget, [this]() -> std::optional<Status> {
      return paused && paused() ? std::optional(Status::paused) : std::nullopt;
    });
  }
  /// After `solve`.
  [[nodiscard]] const Planner& planner() const { return *planner_; }

  const PlannerKind& kind;
  Options options;
  std::unique_ptr<Instance> instance;
  std::shared_ptr<ChangingValidity> validity;
  RecordingGuidance guidance;
  Search search;
  std::function<bool()> paused;  ///< called before every step: whether the loop pauses
  bool guided = false;

 private:
  std::uint64_t seed_;
  std::unique_ptr<Planner> planner_;
};

}  // namespace trellis::test
