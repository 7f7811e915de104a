// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/choice.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include <trellis/base/error.hpp>

namespace trellis::command {

namespace {

template <class T, class Name>
void choose(std::vector<T>& all, const std::string& option, const std::string& wanted, const Name& name) {
  if (wanted.empty()) return;
  std::vector<std::string> known;
  known.reserve(all.size());
  for (const T& one : all) known.push_back(name(one));
  if (std::find(known.begin(), known.end(), wanted) == known.end()) {
    throw Error(fmt::format("{}: the script has none that is called '{}'{}; it has: {}", option, wanted,
                            did_you_mean(wanted, known), fmt::join(known, ", ")));
  }
  std::erase_if(all, [&](const T& one) { return name(one) != wanted; });
}

}  // namespace

void choose_problem(Experiment& experiment, const std::string& name) {
  choose(experiment.problems, "--problem", name, [](const Problem& p) { return p.name; });
}

void choose_strategy(Experiment& experiment, const std::string& name) {
  choose(experiment.strategies, "--strategy", name, [](const auto& s) { return s.first; });
}

}  // namespace trellis::command
