// SPDX-License-Identifier: GPL-3.0-or-later
// The page of stored results.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include <trellis/base/error.hpp>
#include <trellis/figures/html_content.hpp>
#include <trellis/planner/planner.hpp>

namespace trellis {

namespace {

using Json = nlohmann::json;

double number(const Json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

/// A status as reports print it, from its name in documents.
std::string status_text(const std::string& name) {
  static constexpr std::array names = {
      std::pair{"untried", Status::untried},           std::pair{"budget_spent", Status::budget_spent},
      std::pair{"no_path", Status::no_path},           std::pair{"invalid_start", Status::invalid_start},
      std::pair{"invalid_goal", Status::invalid_goal}, std::pair{"interrupted", Status::interrupted}};
  const auto* const found =
      std::find_if(names.begin(), names.end(), [&](const auto& known) { return known.first == name; });
  return found != names.end() ? std::string(to_string(found->second)) : name;
}

HtmlOutcome outcome_of(const Json& run) {
  HtmlRunFacts facts{.solved = run.at("solved").get<bool>(),
                     .length = number(run.at("length")),
                     .status = status_text(run.at("status").get<std::string>()),
                     .checks = run.at("validity_checks").get<std::uint64_t>(),
                     .seconds = number(run.at("time_s"))};
  if (const auto driven = run.find("trajectory"); driven != run.end()) {
    facts.duration = driven->at("duration_s").get<double>();
  }
  return {html_outcome(facts), facts.solved, nullptr};
}

void add_runs(HtmlContent& content, const Json& runs) {
  const std::vector<ProblemSummary>& problems = content.summary.problems;
  const std::vector<ExperimentSummary::Strategy>& strategies = content.summary.strategies;
  for (const Json& run : runs) {
    const auto problem = run.at("problem").get<std::string>();
    const auto strategy = run.at("strategy").get<std::string>();
    const auto p = std::find_if(problems.begin(), problems.end(),
                                [&](const ProblemSummary& known) { return known.problem == problem; });
    const auto s = std::find_if(strategies.begin(), strategies.end(),
                                [&](const ExperimentSummary::Strategy& known) { return known.name == strategy; });
    if (p == problems.end() || s == strategies.end()) continue;
    content.runs[static_cast<std::size_t>(p - problems.begin())][static_cast<std::size_t>(s - strategies.begin())]
        .emplace(run.at("seed").get<std::uint64_t>(), outcome_of(run));
  }
}

}  // namespace

HtmlContent stored_html_content(const ExperimentSummary& summary, const std::string& document,
                                const std::string& file) {
  HtmlContent content{summary, {}, {}};
  content.costs.add(document, file);
  content.costs = content.costs.without_ablations();
  content.costs.baseline = content.costs.reference();
  content.runs.assign(summary.problems.size(), std::vector<HtmlOutcomes>(summary.strategies.size()));
  try {
    add_runs(content, Json::parse(document).at("runs"));
  } catch (const Json::exception&) {
    throw Error(fmt::format("{}: this is no document that trellis run --json writes", file));
  }
  return content;
}

}  // namespace trellis
