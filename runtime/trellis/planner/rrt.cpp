// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include <trellis/planner/tree_planner.hpp>

namespace trellis {

namespace {

struct RrtSettings : CommonSettings {
  double step = 0.5;
  bool connect_goal = true;
};

const Settings<RrtSettings>& rrt_settings() {
  static const Settings<RrtSettings> settings = with_common(
      Settings<RrtSettings>(Component::Kind::planner, "rrt",
                            "rapidly-exploring random tree: grows from the start towards proposals",
                            "LaValle and Kuffner 2001, Randomized kinodynamic planning")
          .number("step", &RrtSettings::step, "m in the metric", Range::at_least(1e-6), "longest extension of the tree")
          .boolean("connect_goal", &RrtSettings::connect_goal,
                   "try the motion to the goal from every new node within one step of it"));
  return settings;
}

class Rrt final : public StartTreePlanner {
 public:
  Rrt(const RrtSettings& settings, PlannerContext context)
      : StartTreePlanner(std::move(context), settings.step), connect_goal_(settings.connect_goal) {}

 protected:
  [[nodiscard]] std::size_t nodes() const override { return tree_->size(); }
  [[nodiscard]] std::optional<std::size_t> goal_to_connect(View target) const override {
    if (solved_ || !connect_goal_) return std::nullopt;
    const auto nearest = context_.instance.nearest_goal(target);
    return nearest.distance <= step_ ? std::optional(nearest.goal) : std::nullopt;
  }

 private:
  bool connect_goal_;
};

}  // namespace

PlannerKind rrt_kind() {
  return {&rrt_settings().component(), [](const Options& o) { return common_of(rrt_settings().read(o)); },
          [](const Options& o, PlannerContext context) -> std::unique_ptr<Planner> {
            return std::make_unique<Rrt>(rrt_settings().read(o), std::move(context));
          },
          false};
}

}  // namespace trellis
