// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/planner.hpp>

#include <algorithm>

#include <trellis/base/error.hpp>
#include <trellis/planner/common_options.hpp>
#include <trellis/planner/kinds.hpp>
#include <trellis/planner/loop.hpp>

namespace trellis {

std::string_view to_string(Status status) {
  switch (status) {
    case Status::untried: return "untried";
    case Status::solved: return "solved";
    case Status::budget_spent: return "budget spent";
    case Status::no_path: return "no path";
    case Status::invalid_start: return "invalid start";
    case Status::invalid_goal: return "invalid goal";
    case Status::interrupted: return "interrupted";
  }
  throw Fault("unknown status");
}

const std::vector<PlannerKind>& planner_kinds() {
  static const std::vector<PlannerKind> kinds = {rrt_kind(),           rrt_connect_kind(),   prm_kind(),
                                                 lazy_prm_kind(),      rrt_star_kind(),      prm_star_kind(),
                                                 lazy_prm_star_kind(), lazy_rrg_star_kind(), kinodynamic_rrt_kind(),
                                                 graph_search_kind(),  best_first_kind()};
  return kinds;
}

const PlannerKind* find_planner(std::string_view name) {
  const auto& kinds = planner_kinds();
  const auto it = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.component->name == name; });
  return it != kinds.end() ? &*it : nullptr;
}

bool every_planner_has(std::string_view option) {
  static const auto common =
      with_common(Settings<CommonSettings>(Component::Kind::planner, "planner", "what every planner has", ""));
  return common.component().find(option) != nullptr;
}

}  // namespace trellis
