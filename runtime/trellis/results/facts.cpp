// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/results/facts.hpp>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

std::string_view to_string(NodeClass c) {
  switch (c) {
    case NodeClass::create: return "create";
    case NodeClass::merge: return "merge";
    case NodeClass::expand: return "expand";
    case NodeClass::oversample: return "oversample";
    case NodeClass::invalid: return "invalid";
  }
  throw Fault("unknown class of nodes");
}

const std::array<const char*, 5>& resolved_names() {
  static constexpr std::array<const char*, 5> names = {"none", "schedule", "order", "one_by_one", "together"};
  return names;
}

CensoredCost path_cost(const RunFacts& run) {
  return {static_cast<double>(run.validity_checks - run.improvement_checks), run.solved};
}

std::string ExperimentFacts::baseline() const {
  if (!given_baseline.empty()) return given_baseline;
  std::vector<const StrategyFacts*> whole;
  for (const StrategyFacts& one : strategies) {
    if (one.ablation.empty()) whole.push_back(&one);
  }
  if (whole.size() < 2) return "";
  const auto plain = std::find_if(whole.begin(), whole.end(), [](const StrategyFacts* one) { return !one->guided; });
  return (plain != whole.end() ? *plain : whole.front())->name;
}

std::vector<const RunFacts*> ExperimentFacts::select(const std::string& problem, const std::string& strategy) const {
  std::vector<const RunFacts*> chosen;
  for (const RunFacts& run : runs) {
    if ((problem.empty() || run.problem == problem) && run.strategy == strategy) chosen.push_back(&run);
  }
  return chosen;
}

void read_experiment(const std::string& line, ExperimentFacts& facts) {
  const Json json = Json::parse(line);
  facts.description = line;
  for (const Json& one : json.at("problems")) {
    facts.problems.push_back({.name = one.at("name").get<std::string>(),
                              .group = text_of(one, "group"),
                              .tuned = one.value("tuned", false)});
    facts.spatial = facts.spatial || (facts.problems.size() == 1 && one.value("world_dimension", Json(2)) == 3);
  }
  for (const Json& one : json.at("strategies")) {
    StrategyFacts& strategy = facts.strategies.emplace_back();
    strategy.name = one.at("name").get<std::string>();
    strategy.text = one.at("text").get<std::string>();
    strategy.shares = text_of(one, "shares");
    if (const auto spec = one.find("spec"); spec != one.end()) strategy.spec = spec->dump();
    // Missing in documents of before.
    strategy.guided = one.value("guided", strategy.text.find(" >> ") != std::string::npos);
    for (const Json& guide : one.value("guides", Json::array())) {
      strategy.guides.push_back({text_of(guide, "key"), text_of(guide, "guide"), text_of(guide, "equal")});
    }
  }
  for (const Json& link : json.value("ablations", Json::array())) {
    for (StrategyFacts& strategy : facts.strategies) {
      if (strategy.name != text_of(link, "strategy")) continue;
      strategy.ablation = text_of(link, "text");
      strategy.of = text_of(link, "of");
    }
  }
  facts.seeds = json.value("seeds", std::vector<std::uint64_t>());
  facts.given_baseline = text_of(json, "baseline");
  facts.ablation = json.value("ablation", 0.0);
  const Json measure = json.value("measure", Json());
  facts.measured = measure.is_object();
  if (!facts.measured) return;
  facts.target = text_of(measure, "text");
  facts.tubes = text_of(measure, "tubes");
  facts.omitted = text_of(measure, "omitted");
  facts.estimators = measure.value("estimators", std::vector<std::string>());
}

}  // namespace trellis
