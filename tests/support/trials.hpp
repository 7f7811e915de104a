// SPDX-License-Identifier: GPL-3.0-or-later
// Trials of guides relative to the same planner without them, for the scenarios of the guides' benefits.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/measure/censored_cost.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/testing.hpp>
#include <trellis/trial/paired_runs.hpp>

#include "support/worlds.hpp"

namespace trellis::test {

/// A strategy on 30 seeds.
inline testing::Trial tried(StrategySpec strategy, const Problem& problem) {
  return testing::trial("", std::move(strategy), problem, testing::seeds(30));
}

/// The median ratio of the validity checks to those of another strategy on the same seeds is at most `most`. A run
/// without a path costs infinitely much.
class LittleMore final : public trial::Matcher {
 public:
  explicit LittleMore(testing::Trial plain) : plain_(std::move(plain)) {}

  [[nodiscard]] std::string text() const override {
    return fmt::format("spends at most {:g} times the validity checks of {} at the median", most, plain_.name());
  }
  [[nodiscard]] trial::Verdict judge(const testing::Trial& guided) const override {
    std::vector<double> ratios;
    trial::Verdict verdict;
    double worst = -1.0;
    std::size_t lost = 0;
    for (const auto& [mine, others] : trial::pairs_of(guided.runs(), guided, plain_.runs(), plain_)) {
      const auto here = static_cast<double>(mine->run.validity_checks);
      const auto there = static_cast<double>(others->run.validity_checks);
      lost += others->run.solved && !mine->run.solved ? 1 : 0;
      const double ratio = cost_ratio({here, mine->run.solved}, {there, others->run.solved});
      ratios.push_back(ratio);
      if (ratio <= worst) continue;
      worst = ratio;
      verdict.worst = mine->seed;
      verdict.why_worst = fmt::format("spent {:g} validity checks, {:g} by {}", here, there, plain_.name());
    }
    const double middle = median(ratios);
    verdict.holds = middle <= most;
    if (verdict.holds) verdict.worst.reset();
    verdict.finding = fmt::format("{:.2f} times as many at the median, {:.2f} at the worst of {} seeds; {} lost a path",
                                  middle, worst, ratios.size(), lost);
    return verdict;
  }

  static constexpr double most = 2.2;

 private:
  testing::Trial plain_;
};
// NOLINTNEXTLINE(readability-identifier-naming): as Catch2's are
inline testing::Matches SpendsLittleMoreThan(testing::Trial plain) {
  return testing::Matches(std::make_shared<LittleMore>(std::move(plain)));
}

/// Bounded loss, on each seed: a guide may mislead, and the run spends at most twice the checks and the work of its
/// planner alone, a constant, and one step.
class BoundedLossHolds final : public trial::Matcher {
 public:
  explicit BoundedLossHolds(testing::Trial plain) : plain_(std::move(plain)) {}

  [[nodiscard]] std::string text() const override {
    return fmt::format("spends at most what bounded loss permits beside {}", plain_.name());
  }
  [[nodiscard]] trial::Verdict judge(const testing::Trial& guided) const override {
    trial::Verdict verdict;
    double worst = -std::numeric_limits<double>::infinity();
    for (const auto& [mine, others] : trial::pairs_of(guided.runs(), guided, plain_.runs(), plain_)) {
      const BoundedLoss& law = mine->run.bounded;
      const bool lost = others->run.solved && !mine->run.solved;
      const auto compare = [&](const char* what, double cost, double alone, double beside) {
        const double most = law.bound * alone + beside;
        const double beyond = lost || law.bound == 0.0 ? std::numeric_limits<double>::infinity() : cost - most;
        if (beyond <= worst) return;
        worst = beyond;
        verdict.worst = mine->seed;
        verdict.why_worst = fmt::format("{:g} {} of at most {:g}; {:g} without guides{}", cost, what, most, alone,
                                        lost ? "; it lost a path" : "");
      };
      compare("work", mine->run.work, others->run.work, law.constant.work + law.largest_step.work);
      compare("checks", static_cast<double>(mine->run.validity_checks),
              static_cast<double>(others->run.validity_checks), law.constant.checks + law.largest_step.checks);
    }
    verdict.holds = worst <= 0.0;
    if (verdict.holds) verdict.worst.reset();
    verdict.finding = fmt::format("{:g} more than permitted at the worst", worst);
    return verdict;
  }

 private:
  testing::Trial plain_;
};
inline testing::Matches LosesLittle(testing::Trial plain) {  // NOLINT(readability-identifier-naming): as Catch2's are
  return testing::Matches(std::make_shared<BoundedLossHolds>(std::move(plain)));
}

inline GuideSpec guide(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  return GuideSpec::make(name, given);
}
/// A guide whose space is searched by two trees.
inline GuideSpec by_two_trees(const std::string& name, const std::vector<Options::Entry>& given = {},
                              double step = 0.5) {
  return GuideSpec::make(name, given, PlannerSpec::make("rrt_connect", {{"step", step}}));
}

inline PlannerSpec tree(double step = 0.5) {
  return PlannerSpec::make("rrt", {{"step", step}, {"proposals", std::int64_t{20000}}});
}
/// The planner without the bound on its guide's cost, whose runs are those of the guide alone: with a bound half of the
/// work is unguided, which hides the benefit of a guide that saves less than half.
inline PlannerSpec trusting(const PlannerSpec& planner) {
  auto options = planner.options().entries();
  std::erase_if(options, [](const auto& entry) { return entry.first == "bound"; });
  options.emplace_back("bound", 0.0);
  return PlannerSpec::make(planner.name(), options);
}
/// A roadmap with so few nodes that it often misses a narrow passage.
inline PlannerSpec roadmap() { return PlannerSpec::make("prm", {{"proposals", std::int64_t{4000}}}); }

inline Problem boxes(const std::string& name, const Rectangles& all, const Configuration& start,
                     const Configuration& goal) {
  return make_problem(name, rectangle_world(all), rectangle_robot(), start, goal);
}

/// A wall from side to side with one passage in its middle.
inline Problem passage(double width, double length) {
  return boxes(
      "passage",
      {{5 - length / 2, 0, 5 + length / 2, 5 - width / 2}, {5 - length / 2, 5 + width / 2, 5 + length / 2, 10}},
      {1, 8.5, 0}, {9, 1.5, 0});
}
/// One block in the middle.
inline Problem open_world() { return boxes("open", {{4.5, 4.5, 5.5, 5.5}}, {1, 5, 0}, {9, 5, 0}); }
/// Rows of boxes with gaps that the robot fits into.
inline Problem rows() {
  Rectangles all;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 6; ++row) {
      const double x = 3 + column * 1.1;
      const double y = 1.5 + row * 1.2;
      all.push_back({x, y, x + 0.7, y + 0.7});
    }
  }
  return boxes("rows", all, {1, 5, 0}, {9, 5, 0});
}
/// Corridors with corners, and a robot that is too long to turn around most of them.
inline Problem alleys() {
  return make_problem("alleys", rectangle_world({{3, 1, 4.6, 6}, {5, 1, 7, 4.6}, {3, 6.4, 7, 9}, {5, 5, 7, 6}}),
                      rectangle_robot(1.6, 0.2), {2, 5, 0}, {8, 5, 0});
}
/// A wall of pickets with slits that only a point passes; there is free space below it.
inline Problem pickets() {
  Rectangles all;
  for (int i = 0; i < 6; ++i) {
    const double y = 2.5 + i * 1.25;
    all.push_back({4.8, y, 5.2, i == 5 ? 10 : y + 1.13});
  }
  return boxes("pickets", all, {2, 6, 0}, {8, 6, 0});
}
/// A wall with a slit that is too narrow for the robot but not for half of it; and a route around it.
inline Problem detour() { return boxes("detour", {{4, 1, 6, 4.94}, {4, 5.06, 6, 10}}, {2, 5, 0}, {8, 5, 0}); }

}  // namespace trellis::test
