// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/core/program.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include <trellis/base/error.hpp>

namespace trellis::dsl {

std::vector<std::uint64_t> consecutive_seeds(std::uint64_t first, std::uint64_t count) {
  return trial::seeds(count, first);
}

void override_seeds(Program& program, std::optional<std::uint64_t> count, std::optional<std::uint64_t> first) {
  if (!count && !first) return;
  program.seed = first.value_or(program.seed);
  program.experiment.seeds = consecutive_seeds(program.seed, count.value_or(program.experiment.seeds.size()));
}

void ablate_all(Experiment& experiment, const std::string& what) {
  const auto& links = experiment.ablations;
  std::vector<std::string> names;
  bool guided = false;
  for (const auto& [name, strategy] : experiment.strategies) {
    if (strategy.guide() == nullptr) continue;
    guided = true;
    const bool done = std::any_of(links.begin(), links.end(), [&, &taken = name](const AblationLink& link) {
      return link.of == taken || link.strategy == taken;
    });
    if (!done) names.push_back(name);
  }
  if (!guided) throw Error(fmt::format("{}: no strategy has a guide that could be taken out", what));
  ablate(experiment, names);
}

}  // namespace trellis::dsl
