// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/core/replaced.hpp>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis::dsl {

namespace {

constexpr std::string_view comparison =
    "a script compares the files of --out with published figures, as examples/paper/compare.py does";
constexpr std::string_view mixtures = "examples/paper/attali.lua composes the guides of dr_rrt and irc";
constexpr std::string_view misleading = "examples/pays/experiment.lua has it, as pays.groups { catalogue = true }";
constexpr std::string_view estimator = "knn {} has the least error where the truth is known";

/// Words of earlier versions, and what replaces each.
constexpr std::array<std::pair<std::string_view, std::string_view>, 26> replaced = {{
    {"published", comparison},
    {"claim", comparison},
    {"kde", estimator},
    {"histogram", estimator},
    {"legacy", estimator},
    {"ablations", "experiment { ablate = true } adds the strategies without each guide"},
    {"fewer_than", "below(trial) compares with another trial"},
    {"more_than", "above(trial) compares with another trial"},
    {"robot.polygon", "robot.rigid { polygon { ... } }"},
    {"strategies.rrt", "rrt {}"},
    {"strategies.rrt_connect", "rrt_connect {}"},
    {"strategies.hybrid", mixtures},
    {"strategies.blend", mixtures},
    {"strategies.skeleton", "skeleton() >> rrt {}"},
    {"strategies.shrinking", "shrink(0.25) >> shrink(0.5) >> shrink(0.75) >> rrt {}"},
    {"strategies.biases", "0.5*uniform() + 0.3*gaussian() + 0.2*bridge_test() >> rrt {}"},
    {"worlds.block", misleading},
    {"worlds.thin_wall", misleading},
    {"worlds.detour", misleading},
    {"worlds.alleys", misleading},
    {"worlds.pickets", misleading},
    {"worlds.rows", misleading},
    {"worlds.open_world", "problem { ... } with a world that has bounds alone"},
    {"worlds.open_space", "problem { ... } with a world that has bounds alone"},
    {"paper", "examples/paper/attali.lua has its functions; a script beside the folder requires \"paper.attali\""},
    {"pays", "examples/pays/experiment.lua has its functions; a script beside the folder requires \"pays.experiment\""},
}};

}  // namespace

std::string suggestion(const std::string& name, const std::vector<std::string>& known, const std::string& module) {
  const std::string word = module.empty() ? name : module + '.' + name;
  const auto* const it =
      std::find_if(replaced.begin(), replaced.end(), [&](const auto& entry) { return entry.first == word; });
  return it != replaced.end() ? ": " + std::string(it->second) : did_you_mean(name, known);
}

}  // namespace trellis::dsl
