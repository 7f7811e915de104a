// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/planner.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <variant>

#include <trellis/base/error.hpp>
#include <trellis/planner/common_options.hpp>
#include <trellis/planner/kinds.hpp>
#include <trellis/planner/lookahead.hpp>
#include <trellis/planner/own_planner.hpp>
#include <trellis/planner/step.hpp>

namespace trellis {

#define TRELLIS_DECLARED(name) PlannerKind name##_kind();
TRELLIS_PLANNERS(TRELLIS_DECLARED)
#undef TRELLIS_DECLARED

std::string_view to_string(Status status) {
  switch (status) {
    case Status::untried: return "untried";
    case Status::solved: return "solved";
    case Status::budget_spent: return "budget spent";
    case Status::no_path: return "no path";
    case Status::invalid_start: return "invalid start";
    case Status::invalid_goal: return "invalid goal";
    case Status::interrupted: return "interrupted";
    case Status::paused: return "paused";
  }
  throw Fault("unknown status");
}

std::optional<Status> Planner::work() {
  throw Fault(fmt::format("the planner{} plans a step without a proposal, and does not override Planner::work",
                          context_.name.empty() ? "" : fmt::format(" '{}'", context_.name)));
}

Solution Planner::solve(Guidance& h, const Budget& budget, const std::function<std::optional<Status>()>& limit) {
  BudgetMonitor monitor(context_.instance, context_.search, budget);
  Lookahead alone(context_.instance, h, nullptr);
  Lookahead& ahead = context_.ahead != nullptr ? *context_.ahead : alone;
  ahead.clear();
  Configuration proposal(context_.instance.space.dimension());
  std::optional<Status> ended = begin(budget);
  while (!ended) {
    std::optional<Status> reached;
    if (monitor.reached(draws())) {
      reached = Status::budget_spent;
    } else if (limit) {
      reached = limit();
    }
    if (reached) {
      ended = stopped(*reached);
    } else if (const Plan next = plan(); next.proposal) {
      const Lookahead::Timed timed = ahead.begin_step(*this);
      draw_proposal(h, next, stream(), context_.search, proposal);
      ahead.drawn(proposal);
      record_outcome(h, extend(proposal), context_.search);
      ended = follow();
    } else {
      ended = work();
    }
  }
  return solution_of(*this, context_.instance, *ended);
}

namespace {

std::vector<PlannerKind> built_in() {
#define TRELLIS_MADE(name) name##_kind(),
  return {TRELLIS_PLANNERS(TRELLIS_MADE)};
#undef TRELLIS_MADE
}

/// The planners of programs that link the library, until planner_kinds() collects them.
struct Registered {
  std::vector<PlannerKind> kinds;
  bool collected = false;
};
Registered& registered() {
  static Registered all;
  return all;
}

const Component& common_component() {
  static const auto common =
      with_common(Settings<CommonSettings>(Component::Kind::planner, "planner", "what every planner has", ""));
  return common.component();
}

bool is_identifier(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  return !name.empty() && letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || digit(c); });
}

/// Checks the description of a planner's options.
void check_options(const Component& component) {
  std::set<std::string> names;
  for (const Option& option : component.options) {
    const std::string what = fmt::format("register_planner: option '{}' of planner '{}'", option.name, component.name);
    if (!is_identifier(option.name)) throw Error(what + " has a name that is no identifier");
    if (!names.insert(option.name).second) throw Error(what + " is declared twice");
    if (option.doc.empty()) throw Error(what + " has no description");
    const auto* number = std::get_if<double>(&option.default_value);
    if (option.type == Option::Type::file || (number != nullptr && std::isinf(*number))) continue;
    try {
      Options::validate(component, {{option.name, option.default_value}});
    } catch (const Error& error) {
      throw Error(fmt::format("{} has a default that it does not accept: {}", what, error.what()));
    }
  }
  for (const Option& option : common_component().options) {
    if (names.contains(option.name)) continue;
    throw Error(
        fmt::format("register_planner: planner '{}' has no option '{}', which every planner has; make its "
                    "settings by with_common()",
                    component.name, option.name));
  }
}

}  // namespace

const std::vector<PlannerKind>& planner_kinds() {
  static const std::vector<PlannerKind> kinds = [] {
    std::vector<PlannerKind> all = built_in();
    all.insert(all.end(), registered().kinds.begin(), registered().kinds.end());
    registered().collected = true;
    return all;
  }();
  return kinds;
}

void register_planner(const PlannerKind& kind) {
  if (kind.component == nullptr || kind.common == nullptr || kind.make == nullptr) {
    throw Error("register_planner: a planner needs its component, common and make");
  }
  const Component& component = *kind.component;
  if (!is_identifier(component.name)) {
    throw Error(fmt::format("register_planner: the name of a planner must be an identifier, as my_rrt, got '{}'",
                            component.name));
  }
  if (component.kind != Component::Kind::planner) {
    throw Error(fmt::format("register_planner: '{}' is declared as a {}; expected Component::Kind::planner",
                            component.name, to_string(component.kind)));
  }
  if (component.summary.empty()) {
    throw Error(fmt::format("register_planner: planner '{}' has no summary, which help and the reference print",
                            component.name));
  }
  std::vector<PlannerKind> known = built_in();
  known.insert(known.end(), registered().kinds.begin(), registered().kinds.end());
  for (const PlannerKind& other : known) {
    if (other.component->name != component.name) continue;
    throw Error(fmt::format("register_planner: there is a planner '{}' already; choose another name", component.name));
  }
  check_options(component);
  if (registered().collected) {
    throw Error(
        fmt::format("register_planner: planner '{}' comes too late; register planners at the beginning of the "
                    "program, before the first script or strategy",
                    component.name));
  }
  registered().kinds.push_back(kind);
}

const PlannerKind* find_planner(std::string_view name) {
  const auto& kinds = planner_kinds();
  const auto it = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.component->name == name; });
  return it != kinds.end() ? &*it : nullptr;
}

bool every_planner_has(std::string_view option) { return common_component().find(option) != nullptr; }

}  // namespace trellis
