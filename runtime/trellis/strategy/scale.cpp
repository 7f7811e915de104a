// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/scale.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/motion/motion_model.hpp>
#include <trellis/strategy/registry.hpp>

namespace trellis {

namespace {

template <std::size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Lengths whose numbers of cells, triangles or points have smaller limits where they are made.
bool is_counted(std::string_view option) {
  constexpr std::array<std::string_view, 3> names = {"cell", "size", "spacing"};
  return is_one_of(option, names);
}

bool is_length(std::string_view unit) {
  constexpr std::array<std::string_view, 3> units = {"m", "m in the metric", "metres"};
  return is_one_of(unit, units);
}

/// Units of what may be tried for a single proposal.
bool is_attempts(std::string_view unit) {
  constexpr std::array<std::string_view, 3> units = {"controls", "pairs", "configurations"};
  return is_one_of(unit, units);
}

std::string value_text(const Option& option, const OptionValue& value) {
  return option.unit.empty() ? to_string(value) : fmt::format("{} {}", to_string(value), option.unit);
}

void check_number(const Component& component, const Option& option, const OptionValue& value, const Problem& problem) {
  const auto* number = std::get_if<double>(&value);
  if (number == nullptr || !(*number > 0.0) || is_counted(option.name)) return;
  const bool share = option.unit == "share of the optimum";
  if (!share && !is_length(option.unit)) return;
  const double extent = share ? 1.0 : problem.space.diameter();
  const double least = extent / most_parts;
  if (*number >= least) return;
  throw Error(fmt::format("{}: option '{}' is {}, which divides {} into more than {:g} parts; expected at least {:.3g}",
                          component.name, option.name, value_text(option, value),
                          share ? "it" : fmt::format("the {:.3g} m of problem '{}'", extent, problem.name), most_parts,
                          least));
}

void check_count(const Component& component, const Option& option, const OptionValue& value) {
  const auto* count = std::get_if<std::int64_t>(&value);
  if (count == nullptr || !is_attempts(option.unit) || static_cast<double>(*count) <= most_parts) return;
  throw Error(fmt::format("{}: option '{}' is {} for each proposal; expected at most {:g}", component.name, option.name,
                          value_text(option, value), most_parts));
}

void check_options(const std::string& name, Component::Kind kind, const Options& options, const Problem& problem) {
  // Parts of scripts are not in the registry, and check their options themselves.
  const Component* component = find_component(kind, name);
  if (component != nullptr) check_scale(*component, options.entries(), problem);
}

void check_planner(const PlannerSpec& planner, const Problem& problem) {
  check_options(planner.name(), Component::Kind::planner, planner.options(), problem);
}

void check_guide(const GuideSpec& guide, const Problem& problem) {
  for (const auto& term : guide.terms()) check_guide(term.guide, problem);
  if (guide.kind() != GuideSpec::Kind::component) return;
  if (guide.custom() == nullptr) check_options(guide.name(), Component::Kind::guide, guide.options(), problem);
  if (guide.planner_given()) check_planner(*guide.planner(), problem);
  if (guide.below() != nullptr) check_guide(*guide.below(), problem);
}

/// Checks the distances that the bounds of a speed cover in one step.
void check_speed(const std::string& axis, double lo, double hi, const Problem& problem) {
  constexpr std::array<std::string_view, 2> speeds = {"speed", "v"}, turns = {"angular_speed", "omega"};
  // Those of a team have numbers: speed, speed2, ...
  const std::string_view name = std::string_view(axis).substr(0, axis.find_last_not_of("0123456789") + 1);
  const bool turn = is_one_of(name, turns);
  if (!turn && !is_one_of(name, speeds)) return;
  const double extent = turn ? 2.0 * std::numbers::pi : problem.space.diameter();
  // The planner limits the steps of one control, and with them smaller steps.
  constexpr double millisecond = 1e-3;
  const double dt = std::max(problem.motion_model->dt(), millisecond);
  const double least = extent / (most_parts * dt);
  const char* unit = turn ? "rad" : "m";
  for (const auto& [option, bound] :
       {std::pair{turn ? "max_angular_speed" : "max_speed", hi}, {turn ? "max_angular_speed" : "min_speed", lo}}) {
    if (bound == 0.0 || std::abs(bound) >= least) continue;
    throw Error(fmt::format(
        "problem '{}': {}: option '{}' is {:g} {}/s, of which more than {:g} steps of {:g} s cross {:.3g} {}; expected "
        "at least {:.3g}",
        problem.name, problem.motion_model->name(), option, bound, unit, most_parts, dt, extent, unit, least));
  }
}

}  // namespace

void check_scale(const Component& component, const std::vector<Options::Entry>& given, const Problem& problem) {
  for (const auto& [name, value] : given) {
    const Option* option = component.find(name);
    if (option == nullptr || value == option->default_value) continue;
    check_number(component, *option, value, problem);
    check_count(component, *option, value);
  }
}

void check_scale(const StrategySpec& strategy, const Problem& problem) {
  check_planner(strategy.planner(), problem);
  if (strategy.guide() != nullptr) check_guide(*strategy.guide(), problem);
}

void check_scale(const Problem& problem) {
  double positions = 0.0;
  for (const Factor& factor : problem.space.factors()) {
    if (factor.kind == Factor::Kind::line) {
      positions = std::hypot(positions, factor.axis.weight * (factor.axis.hi - factor.axis.lo));
    }
  }
  for (const Factor& factor : problem.space.factors()) {
    if (factor.kind == Factor::Kind::line) continue;
    const double period = factor.kind == Factor::Kind::circle ? factor.axis.period() : 2.0 * std::numbers::pi;
    const double turn = factor.axis.weight * period;
    if (positions == 0.0 || turn <= positions || turn <= most_parts * problem.resolution) continue;
    throw Error(fmt::format(
        "problem '{}': option 'weight' is {:g} m/rad, so that a turn is {:.3g} m long, more than {:g} times the "
        "resolution of {:g} m; expected at most {:.3g}",
        problem.name, factor.axis.weight, turn, most_parts, problem.resolution,
        std::max(positions, most_parts * problem.resolution) / period));
  }
  if (problem.motion_model == nullptr) return;
  for (const ControlAxis& axis : problem.motion_model->controls()) check_speed(axis.name, axis.lo, axis.hi, problem);
  for (const Axis& axis : problem.motion_model->velocities()) check_speed(axis.name, axis.lo, axis.hi, problem);
}

}  // namespace trellis
