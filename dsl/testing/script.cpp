// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <tuple>

#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/testing.hpp>

namespace trellis::testing {

struct Script::State {
  std::string path;
  Experiment experiment;
  std::map<std::tuple<std::string, std::string, std::vector<std::uint64_t>>, Trial> trials = {};
};

StrategySpec Script::strategy(const std::string& name) const {
  std::vector<std::string> known;
  for (const auto& [given, strategy] : state_->experiment.strategies) {
    if (given == name) return strategy;
    known.push_back(given);
  }
  throw Error(fmt::format("{}: no strategy is called '{}'{}; there are: {}", state_->path, name,
                          did_you_mean(name, known), fmt::join(known, ", ")));
}

Problem Script::problem(const std::string& name) const {
  const auto& problems = state_->experiment.problems;
  if (name.empty() && problems.size() == 1) return problems.front();
  std::vector<std::string> known;
  for (const Problem& problem : problems) {
    if (problem.name == name) return problem;
    known.push_back(problem.name);
  }
  if (name.empty()) {
    throw Error(fmt::format("{}: it has several problems; name one of {}", state_->path, fmt::join(known, ", ")));
  }
  throw Error(fmt::format("{}: no problem is called '{}'{}; there are: {}", state_->path, name,
                          did_you_mean(name, known), fmt::join(known, ", ")));
}

std::vector<std::string> Script::problems() const {
  std::vector<std::string> names;
  for (const Problem& problem : state_->experiment.problems) names.push_back(problem.name);
  return names;
}

Trial Script::trial(const std::string& strategy, std::vector<std::uint64_t> seeds, const std::string& problem) const {
  auto key = std::tuple(strategy, problem, seeds);
  if (const auto found = state_->trials.find(key); found != state_->trials.end()) return found->second;
  trial::Setup setup{.name = strategy,
                     .strategy = this->strategy(strategy),
                     .problem = this->problem(problem),
                     .seeds = std::move(seeds),
                     .shortcut = state_->experiment.shortcut,
                     .script = state_->path};
  if (state_->experiment.measure) setup.measure = std::make_shared<const Measure>(*state_->experiment.measure);
  return state_->trials.emplace(std::move(key), Trial(std::move(setup))).first->second;
}

Script load(const std::string& path) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::string>, Script> loaded;
  std::string text = dsl::read_file(path);
  const std::scoped_lock lock(mutex);
  const auto found = loaded.find({path, text});
  if (found != loaded.end()) return found->second;
  auto state = std::make_shared<Script::State>(Script::State{path, dsl::load_script(path).experiment});
  return loaded.emplace(std::pair(path, std::move(text)), Script(std::move(state))).first->second;
}

}  // namespace trellis::testing
