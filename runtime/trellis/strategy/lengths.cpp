// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/lengths.hpp>

#include <algorithm>
#include <utility>

#include <trellis/planner/planner.hpp>

namespace trellis {

bool is_length(const Option& option) { return option.unit == "m" || option.unit == "m in the metric"; }

PlannerSpec with_lengths_of(const std::vector<const PlannerSpec*>& above, const PlannerSpec& standard) {
  const Component& component = *find_planner(standard.name())->component;
  std::vector<Options::Entry> entries = standard.options().entries();
  bool changed = false;
  for (auto& [name, value] : entries) {
    const Option& option = *component.find(name);
    // What the guide itself sets stays.
    if (!is_length(option) || value != option.default_value) continue;
    const auto nearest = std::find_if(above.rbegin(), above.rend(), [&, &taken = name](const PlannerSpec* planner) {
      return find_planner(planner->name())->component->find(taken) != nullptr;
    });
    if (nearest == above.rend()) continue;
    const Option& theirs = *find_planner((*nearest)->name())->component->find(name);
    const OptionValue& given = (*nearest)->options().at(name);
    if (theirs.unit != option.unit || given == theirs.default_value) continue;
    value = given;
    changed = true;
  }
  return changed ? PlannerSpec::make(standard.name(), entries, standard.origin()) : standard;
}

}  // namespace trellis
