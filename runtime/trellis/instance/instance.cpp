// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/instance.hpp>

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include <trellis/base/slice_monitor.hpp>

namespace trellis {

std::optional<Proximity> Validity::nearest_obstacle(View q) {
  static_cast<void>(q);
  throw Error("no collision check decides validity in this space, so it has no nearest obstacle");
}

namespace {

/// Announces a check and the distance from obstacles.
void announce_distance(const CheckCost& cost) {
  announce_checks(1);
  announce_work(std::max(0.0, cost.distance - cost.alone));
}

/// The validity of states: within the bounds of the space and the limits of the motion model, and free of collision.
class StateValidity final : public Validity {
 public:
  StateValidity(std::shared_ptr<Validity> configurations, Space space, std::shared_ptr<const MotionModel> model)
      : configurations_(std::move(configurations)), space_(std::move(space)), model_(std::move(model)) {}
  [[nodiscard]] bool state(View x) override { return keeps_limits(x) && configurations_->state(x); }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    if (!keeps_limits(b)) return {false, 1, 1.0};
    return configurations_->motion(a, b);
  }
  void certify(View a, View b, Certificate& certificate) override {
    if (!keeps_limits(b)) {
      certificate.refuted_at = 1.0;
      return;
    }
    configurations_->certify(a, b, certificate);
  }
  [[nodiscard]] double clearance(View x) override { return configurations_->clearance(x); }
  [[nodiscard]] const CheckCost& cost() const override { return configurations_->cost(); }
  [[nodiscard]] std::optional<Contact> contact(View x) override { return configurations_->contact(x); }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View x) override {
    return configurations_->nearest_obstacle(x);
  }

 private:
  [[nodiscard]] bool keeps_limits(View x) const { return space_.contains(x) && model_->admits(x); }

  std::shared_ptr<Validity> configurations_;
  Space space_;
  std::shared_ptr<const MotionModel> model_;
};

/// Apart, so that a search that announces nothing saves no registers for it.
[[gnu::noinline]] MotionReport announced_motion(const Checker& checker, View a, View b) {
  const std::uint32_t most = checker.most_checks(a, b);
  announce_motion_checks(most);
  const MotionReport report = checker.validate(a, b, most);
  withdraw_motion_checks(most - report.checks);
  return report;
}

}  // namespace

const CheckCost& Validity::cost() const {
  static constexpr CheckCost of_one;
  return of_one;
}

bool CollisionValidity::state(View q) {
  announce_checks(1);
  return checker_->valid(q);
}

MotionReport CollisionValidity::motion(View a, View b) {
  return is_monitored() ? announced_motion(*checker_, a, b) : checker_->motion(a, b);
}

void CollisionValidity::announce(View a, View b, const MotionReport& report) {
  const std::uint32_t most = checker_->most_checks(a, b);
  announce_motion_checks(most);
  withdraw_motion_checks(most - report.checks);
}

double CollisionValidity::clearance(View q) {
  announce_distance(cost_);
  return checker_->clearance(q);
}

std::optional<Contact> CollisionValidity::contact(View q) {
  announce_checks(1);
  return checker_->contact(q);
}

std::optional<Proximity> CollisionValidity::nearest_obstacle(View q) {
  announce_distance(cost_);
  return checker_->nearest_obstacle(q);
}

Instance::Announced Instance::open_checks(const CheckCost& cost) {
  if (!is_monitored()) return {};
  const Spending uncounted = thread_monitor->uncounted();
  const SliceMonitor::CheckRates outer = thread_monitor->set_rates({cost.on_motion, cost.alone});
  return {true, uncounted.checks, uncounted.work, outer.on_motion, outer.alone};
}

void Instance::close_checks(const Announced& before) {
  if (!before.monitored) return;
  settle(before, 0.0, 0.0);
  ask();
}

void Instance::settle(const Announced& before, double number, double work) {
  if (!is_monitored()) return;
  thread_monitor->set_rates({before.on_motion, before.alone});
  thread_monitor->settle({before.checks, before.work}, {number, work});
}

void Instance::ask() {
  if (is_monitored()) thread_monitor->announce({});
}

void Instance::announce_proposal() { trellis::announce_proposal(); }

void Instance::spend(double work) {
  if (is_monitored()) thread_monitor->spend(work);
  checks.other += work;
}

std::uint32_t Instance::drive(View from, View control, std::uint32_t steps, Configurations& states,
                              Configuration* blocked) {
  Configuration x(from.begin(), from.end());
  Configuration next(x.size());
  for (std::uint32_t k = 0; k < steps; ++k) {
    motion_model->step(space, x, control, next);
    spend(motion_model->step_work());
    const MotionReport report = motion(x, next);
    if (!report.valid) {
      if (blocked != nullptr) {
        blocked->resize(x.size());
        space.interpolate(x, next, report.invalid_at, *blocked);
      }
      return k;
    }
    states.push(next);
    std::swap(x, next);
  }
  return steps;
}

std::shared_ptr<Validity> make_validity(const std::string& collision, const std::shared_ptr<const Scene>& scene,
                                        const Space& space, double resolution,
                                        const std::shared_ptr<const MotionModel>& motion_model) {
  auto configurations =
      std::make_shared<CollisionValidity>([=] { return make_checker(collision, scene, space, resolution); });
  if (!motion_model) return configurations;
  return std::make_shared<StateValidity>(std::move(configurations), space, motion_model);
}

Instance::NearGoal Instance::nearest_goal(View q) const {
  NearGoal nearest{0, space.distance(q, goal())};
  for (std::size_t i = 1; i < goals.size(); ++i) {
    const double distance = space.distance(q, goals[i]);
    if (distance < nearest.distance) nearest = {i, distance};
  }
  return nearest;
}

void sort_goals(Instance& sub) {
  std::vector<Configuration>& goals = sub.goals;
  if (goals.size() < 2) return;
  const auto outside = [&](const Configuration& q) { return !sub.space.contains(q); };
  if (!std::all_of(goals.begin(), goals.end(), outside)) std::erase_if(goals, outside);
  std::vector<std::pair<double, Configuration>> sorted;
  sorted.reserve(goals.size());
  for (Configuration& q : goals) {
    const double distance = sub.space.distance(sub.start, q);
    sorted.emplace_back(distance, std::move(q));
  }
  std::sort(sorted.begin(), sorted.end());
  goals.clear();
  for (auto& [distance, q] : sorted) {
    if (goals.empty() || goals.back() != q) goals.push_back(std::move(q));
  }
}

std::shared_ptr<Validity> Instance::validity_in(const std::shared_ptr<const Scene>& other) const {
  return validity_of ? validity_of(other) : make_validity(collision, other, space, resolution, motion_model);
}

std::vector<std::pair<std::string, Configuration>> named_ends(const Problem& problem) {
  std::vector<std::pair<std::string, Configuration>> ends = {{"start", problem.start}};
  if (problem.goals.empty()) ends.emplace_back("goal", Configuration());
  for (std::size_t i = 0; i < problem.goals.size(); ++i) {
    ends.emplace_back(problem.goals.size() == 1 ? "goal" : fmt::format("goal {}", i + 1), problem.goals[i]);
  }
  return ends;
}

std::unique_ptr<Instance> make_instance(const Problem& problem) {
  auto instance = std::make_unique<Instance>();
  instance->space = problem.space;
  instance->scene = problem.scene;
  instance->motion_model = problem.motion_model;
  instance->validity =
      make_validity(problem.collision, problem.scene, problem.space, problem.resolution, problem.motion_model);
  instance->start = problem.start;
  instance->goals = problem.goals;
  instance->goal_tolerance = problem.goal_tolerance;
  instance->resolution = problem.resolution;
  instance->collision = problem.collision;
  if (problem.scene->translates()) {
    instance->position_axes.resize(problem.scene->world_dimension());
    std::iota(instance->position_axes.begin(), instance->position_axes.end(), std::size_t{0});
  }
  return instance;
}

}  // namespace trellis
