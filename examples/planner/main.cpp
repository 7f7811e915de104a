// SPDX-License-Identifier: MIT-0
// A planner of one's own: an RRT that extends the nearest of a few random nodes, so that a proposal costs the same in a
// tree of any size. docs/planner.md explains it.
#include <optional>
#include <utility>

#include <trellis/planner/own_planner.hpp>
#include <trellis/program.hpp>

using namespace trellis;

struct SampledRrtSettings : CommonSettings {
  double step = 0.5;
  std::int64_t candidates = 8;
};

const Settings<SampledRrtSettings>& sampled_rrt_settings() {
  static const auto settings = with_common(
      Settings<SampledRrtSettings>(Component::Kind::planner, "sampled_rrt",
                                   "RRT that extends the nearest of a few random nodes", "")
          .number("step", &SampledRrtSettings::step, "m in the metric", Range::positive(), "longest extension")
          .integer("candidates", &SampledRrtSettings::candidates, "nodes", Range::at_least(1),
                   "random nodes; the nearest of them is extended"));
  return settings;
}

class SampledRrt final : public Planner {
 public:
  SampledRrt(const SampledRrtSettings& settings, PlannerContext context)
      : Planner(std::move(context)), settings_(settings), extension_(context_, settings.step) {}

  std::optional<Status> begin(const Budget& /*budget*/) override {
    const Instance& instance = context_.instance;
    // The first call, a call for another path, or an instance that changed. Else the search continues.
    if (root_ == no_node || solved() || epoch_ != instance.epoch()) {
      if (const auto invalid = remove_invalid_goals(context_.instance)) return invalid;
      context_.guidance.restart();
      epoch_ = instance.epoch();
      root_ = best_ = add_node(context_, instance.start);
    }
    return status();
  }

  // The proposal was drawn from h, the guide's part of it included.
  Outcome extend(View proposal) override {
    const Outcome outcome = extension_.extend(node_near(proposal), proposal);
    const std::uint32_t added = outcome.added_row;
    if (added != no_node && to_goal(added) < to_goal(best_)) best_ = added;
    return outcome;
  }

  std::optional<Status> follow() override { return status(); }

  Solution solution(Status status) override { return {status, branch_to(context_.search, best_)}; }

 private:
  View node(std::uint32_t row) const { return std::as_const(context_.search.nodes)[row]; }
  double to_goal(std::uint32_t row) const { return context_.instance.to_goal(node(row)); }
  std::optional<Status> status() const { return solved() ? std::optional(Status::solved) : std::nullopt; }
  bool solved() const { return to_goal(best_) <= context_.instance.goal_tolerance; }

  /// The node that the guide selects, else the nearest of the candidates and of the node nearest to the goal.
  std::uint32_t node_near(View q) {
    const std::uint32_t selected = context_.guidance.vertex();
    if (selected != no_node && selected >= root_) return selected;
    std::uint32_t best = best_;
    for (std::int64_t i = 0; i < settings_.candidates; ++i) {
      const auto drawn = context_.proposals.below(context_.search.nodes.size() - root_);
      const auto row = root_ + static_cast<std::uint32_t>(drawn);
      const Space& space = context_.instance.space;
      if (space.squared_distance(node(row), q) < space.squared_distance(node(best), q)) best = row;
    }
    return best;
  }

  SampledRrtSettings settings_;
  NodeExtension extension_;
  std::uint32_t root_ = no_node;  ///< of the current tree: rows of the search
  std::uint32_t best_ = no_node;  ///< the node nearest to the goal
  std::uint64_t epoch_ = 0;
};

int main(int argc, char** argv) {
  register_planner<sampled_rrt_settings, SampledRrt>();
  return run_program(argc, argv);
}
