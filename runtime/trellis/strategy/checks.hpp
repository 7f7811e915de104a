// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include <trellis/instance/instance.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// Throws Error for a hierarchy that has no end in sight.
void check_depth(const StrategySpec& strategy);
/// The instance of a problem, with its ends as the space writes them.
std::unique_ptr<Instance> root_instance(const Problem& problem);
/// "script.lua:3: ", "" for what was built through C++.
std::string where(const Origin& origin);

}  // namespace trellis
