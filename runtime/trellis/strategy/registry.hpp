// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <trellis/base/component.hpp>

namespace trellis {

/// All components that a script can name: planners, then guides, in a fixed order. The single source of validation,
/// messages, help and the reference.
const std::vector<const Component*>& components();

/// The component of that kind and name.
/// \throws Error with the nearest existing name
const Component& component(Component::Kind kind, std::string_view name);
/// As `component`, but nullptr if there is none.
const Component* find_component(Component::Kind kind, std::string_view name);

}  // namespace trellis
