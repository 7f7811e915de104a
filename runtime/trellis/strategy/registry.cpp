// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/registry.hpp>

#include <fmt/format.h>

#include <algorithm>

#include <trellis/guide/guide.hpp>
#include <trellis/planner/planner.hpp>

namespace trellis {

const std::vector<const Component*>& components() {
  static const std::vector<const Component*> all = [] {
    std::vector<const Component*> list;
    for (const auto& kind : planner_kinds()) {
      if (find_guide(kind.component->name) != nullptr) {
        throw Error(
            fmt::format("register_planner: there is a guide '{}' already; choose another name", kind.component->name));
      }
      list.push_back(kind.component);
    }
    for (const auto& kind : guide_kinds()) list.push_back(kind.component);
    return list;
  }();
  return all;
}

const Component* find_component(Component::Kind kind, std::string_view name) {
  const auto& all = components();
  const auto it =
      std::find_if(all.begin(), all.end(), [&](const Component* c) { return c->kind == kind && c->name == name; });
  return it != all.end() ? *it : nullptr;
}

const Component& component(Component::Kind kind, std::string_view name) {
  if (const Component* found = find_component(kind, name)) return *found;
  std::vector<std::string> known;
  for (const auto* c : components()) {
    if (c->kind == kind) known.push_back(c->name);
  }
  throw Error(fmt::format("unknown {} '{}'{}; there are: {}", to_string(kind), name, did_you_mean(name, known),
                          fmt::join(known, ", ")));
}

}  // namespace trellis
