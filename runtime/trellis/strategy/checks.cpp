// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <trellis/base/error.hpp>
#include <trellis/instance/end_fault.hpp>
#include <trellis/instance/nearest_valid.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/level.hpp>
#include <trellis/strategy/scale.hpp>
#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

namespace {

/// What a start or a goal touches; of a team which robot does.
std::string collision_text(const Contact& contact, const Scene& scene) {
  // The parts of a manipulator's base are no robots of their own in messages.
  const bool team = scene.manipulator() == nullptr && scene.members().size() > 1;
  if (!team) return " is in collision with " + describe(contact, scene);
  const std::string robot = scene.body_name(contact.body);
  return contact.other ? fmt::format(": {} meets {}", robot, scene.body_name(*contact.other))
                       : fmt::format(": {} is in collision with {}", robot, describe(contact, scene));
}

/// Suggests a replacement for an invalid start or goal.
std::string nearest(const Problem& problem, const Configuration& q, const Checker& checker) {
  for (const double x : q) {
    if (!std::isfinite(x)) return "another coordinate is no finite number";
  }
  const auto found = nearest_valid(problem.space, q, [&](View x) { return checker.valid(x); });
  if (!found) return "no valid configuration was found in its space";
  return fmt::format("a valid configuration near by is {}, at a distance of {:.2g}", found->text, found->distance);
}

constexpr int deepest = 64;

int depth(const GuideSpec& guide) {
  if (guide.kind() == GuideSpec::Kind::component) return 1 + (guide.below() != nullptr ? depth(*guide.below()) : 0);
  int most = 0;
  for (const auto& term : guide.terms()) most = std::max(most, depth(term.guide));
  return most;
}

}  // namespace

std::string where(const Origin& origin) {
  return origin.script.empty() ? "" : fmt::format("{}:{}: ", origin.script, origin.line);
}

void check_planner(const PlannerKind& kind, const Instance& instance) {
  const std::string& name = kind.component->name;
  if (!instance.motion_model) {
    if (!kind.kinodynamic) return;
    throw Error(
        fmt::format("{} drives a motion model and this space has none: give the problem one (motion = "
                    "motion.unicycle1 {{}}), or use a planner that joins by straight motions, as rrt",
                    name));
  }
  if (kind.kinodynamic) return;
  throw Error(
      fmt::format("{} joins configurations by straight motions and this space has the motion model {}: use "
                  "kinodynamic_rrt here, or drop the model below it (holonomic() >> kinodynamic_rrt {{}})",
                  name, instance.motion_model->name()));
}

void check(const Problem& problem) {
  if (!problem.scene) throw Error(fmt::format("problem '{}': has no scene", problem.name));
  const std::vector<Axis> axes = problem.space.coordinates();
  if (problem.space.dimension() < problem.scene->robot_dimension()) {
    throw Error(fmt::format("problem '{}': the robot needs {} coordinates and the space {} has {}", problem.name,
                            problem.scene->robot_dimension(), problem.space.name(), problem.space.dimension()));
  }
  if (!(problem.resolution > 0.0) || !std::isfinite(problem.resolution)) {
    throw Error(fmt::format("problem '{}': resolution must be a number greater than 0, in m, got {}", problem.name,
                            problem.resolution));
  }
  if (problem.motion_model && problem.space.dimension() != problem.motion_model->dimension()) {
    throw Error(fmt::format("problem '{}': the states of {} have {} coordinates and the space {} has {}", problem.name,
                            problem.motion_model->text(), problem.motion_model->dimension(), problem.space.name(),
                            problem.space.dimension()));
  }
  if (!(problem.goal_tolerance >= 0.0) || !std::isfinite(problem.goal_tolerance)) {
    throw Error(fmt::format("problem '{}': goal_tolerance must be a number of at least 0, in m, got {}", problem.name,
                            problem.goal_tolerance));
  }
  check_scale(problem);
  const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
  for (const auto& [what, q] : named_ends(problem)) {
    if (q.size() != axes.size()) {
      std::vector<std::string> names;
      names.reserve(axes.size());
      for (const auto& axis : axes) names.push_back(axis.name);
      throw Error(fmt::format("problem '{}': {} has {} coordinate{}, expected {} ({})", problem.name, what, q.size(),
                              q.size() == 1 ? "" : "s", axes.size(), fmt::join(names, ", ")));
    }
    for (std::size_t j = 0; j < q.size(); ++j) {
      if (!std::isfinite(q[j])) {
        throw Error(fmt::format("problem '{}': {}: coordinate {} ({}) is {}, expected a finite number", problem.name,
                                what, j + 1, axes[j].name, q[j]));
      }
    }
    if (const std::string outside = out_of_bounds(problem.space, q); !outside.empty()) {
      throw InvalidEnd(fmt::format("problem '{}': {} is out of bounds: {}; {}", problem.name, what, outside,
                                   nearest(problem, q, *checker)));
    }
    if (problem.motion_model && !problem.motion_model->admits(q)) {
      throw InvalidEnd(fmt::format("problem '{}': {} ({:g}) is out of the limits of {}", problem.name, what,
                                   fmt::join(q, ", "), problem.motion_model->text()));
    }
    if (const auto contact = checker->contact(q)) {
      std::optional<ShapeChecker> shapes;
      const ShapeContact found = shape_contact(problem.scene, q, *contact, shapes);
      throw InvalidEnd(fmt::format("problem '{}': {} ({:g}){}{}; {}", problem.name, what, fmt::join(q, ", "),
                                   collision_text(found.contact, *problem.scene), found.hint,
                                   nearest(problem, q, *checker)));
    }
  }
}

void check_depth(const StrategySpec& strategy) {
  if (strategy.guide() == nullptr || depth(*strategy.guide()) <= deepest) return;
  throw Error(fmt::format("the hierarchy is deeper than {} levels; is it built in an endless loop?", deepest));
}

std::unique_ptr<Instance> root_instance(const StrategySpec& strategy, const Problem& problem) {
  auto instance = make_instance(problem);
  try {
    check_planner(*find_planner(strategy.planner().name()), *instance);
  } catch (const Error& error) {
    throw Error(fmt::format("in {}, level 0 (problem '{}'): {}", strategy.text(), problem.name, error.what()));
  }
  instance->space.normalise(instance->start);
  for (Configuration& goal : instance->goals) instance->space.normalise(goal);
  return instance;
}

namespace {

/// The first location of a part of the guide that has one.
std::string where(const GuideSpec& guide) {
  if (guide.kind() == GuideSpec::Kind::component) return where(guide.origin());
  for (const auto& term : guide.terms()) {
    std::string place = where(term.guide);
    if (!place.empty()) return place;
  }
  return "";
}

void find_unreachable(const GuideSpec& guide, const PlannerSpec& planner, double proposals,
                      std::vector<std::string>& sentences);

/// For parts in order: finds parts that never draw because an earlier part, which searches no space, remains active.
void find_unreachable_behind(const GuideSpec& guide, const char* why, bool keeps, const PlannerSpec& planner,
                             double proposals, std::vector<std::string>& sentences) {
  const GuideSpec* stays = nullptr;
  for (const auto& term : guide.terms()) {
    if (stays != nullptr) {
      sentences.push_back(fmt::format("{}{} never draws: {} stands before it in the {}; {}", where(term.guide),
                                      term.guide.text(), stays->text(), guide.name(), why));
      continue;
    }
    find_unreachable(term.guide, planner, proposals, sentences);
    if (keeps && !term.guide.searches()) stays = &term.guide;
  }
}

void find_unreachable(const GuideSpec& guide, const PlannerSpec& planner, double proposals,
                      std::vector<std::string>& sentences) {
  switch (guide.kind()) {
    case GuideSpec::Kind::component: {
      const PlannerCommon common = find_planner(planner.name())->common(planner.options());
      if ((1.0 - common.goal_bias) * (1.0 - common.uniform) <= 0.0) {
        sentences.push_back(
            fmt::format("{}{} never draws: {} leaves it no share of its proposals (uniform = {:g}, "
                        "goal_bias = {:g})",
                        where(guide), guide.text(), planner.text(), common.uniform, common.goal_bias));
      } else if (guide.below() != nullptr) {
        const PlannerSpec& own = *guide.planner();
        find_unreachable(*guide.below(), own, find_planner(own.name())->common(own.options()).budget.proposals,
                         sentences);
      }
      return;
    }
    case GuideSpec::Kind::sequence:
      for (std::size_t i = 0; i < guide.terms().size(); ++i) {
        const GuideSpec& part = guide.terms()[i].guide;
        const double begins =
            static_cast<double>(i) * static_cast<double>(sequence_settings().read(guide.options()).turn);
        if (begins < proposals) {
          find_unreachable(part, planner, proposals, sentences);
        } else {
          sentences.push_back(
              fmt::format("{}{} never draws: its turn begins after {:g} proposals, and {} ends after {:g}", where(part),
                          part.text(), begins, planner.text(), proposals));
        }
      }
      return;
    case GuideSpec::Kind::schedule: {
      const double turn = schedule_settings().read(guide.options()).turn;
      find_unreachable_behind(guide, "it is never refuted, and there is no turn to end", std::isinf(turn), planner,
                              proposals, sentences);
      return;
    }
    case GuideSpec::Kind::race:
      find_unreachable_behind(guide, "there is nothing to search for, so it wins every race", true, planner, proposals,
                              sentences);
      return;
    case GuideSpec::Kind::mixture:
    case GuideSpec::Kind::blend:
      for (const auto& term : guide.terms()) find_unreachable(term.guide, planner, proposals, sentences);
      return;
  }
}

}  // namespace

void check(const StrategySpec& strategy, const Problem& problem) {
  check_depth(strategy);
  Run run;
  run.problem = problem.name;
  Level root(run, nullptr, "0", "root", root_instance(strategy, problem), strategy.planner(), nullptr);
  if (strategy.guide() != nullptr) root.guide_by(*strategy.guide());
  for (Level* level : run.levels) level->try_planner();
}

void check_unused_guides(const StrategySpec& strategy, const Problem& problem, const RunRecord& run) {
  if (strategy.guide() == nullptr || run.bounded.bound == 0.0 || run.bounded.guides_set_up) return;
  constexpr double most = 3e6;  // validity checks
  if (set_up_work(*strategy.guide(), *problem.scene, 1.0) <= most) check(strategy, problem);
}

std::vector<std::string> unreachable_guides(const StrategySpec& strategy) {
  std::vector<std::string> sentences;
  if (strategy.guide() == nullptr) return sentences;
  const PlannerSpec& planner = strategy.planner();
  find_unreachable(*strategy.guide(), planner, find_planner(planner.name())->common(planner.options()).budget.proposals,
                   sentences);
  return sentences;
}

}  // namespace trellis
