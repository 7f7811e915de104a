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
#include <trellis/report/stored_summaries.hpp>

namespace trellis {

namespace {

using Json = nlohmann::json;

double number(const Json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::string string_or_empty(const Json& object, const char* field) {
  const auto found = object.find(field);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
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

/// Puts the summaries into their cells.
void add_summaries(HtmlContent& content, std::vector<StoredSummary> summaries) {
  const auto place = [](const auto& all, const auto& is) {
    return static_cast<std::size_t>(std::find_if(all.begin(), all.end(), is) - all.begin());
  };
  for (StoredSummary& one : summaries) {
    const std::size_t s =
        place(content.strategies, [&](const HtmlStrategy& known) { return known.name == one.strategy; });
    const std::size_t p = place(content.problems, [&](const std::string& known) { return known == one.problem; });
    if (s == content.strategies.size()) continue;
    content.strategies[s].ablation = one.ablation;
    if (one.problem.empty()) {
      content.together.resize(content.strategies.size());
      content.together[s] = std::move(one.summary);
    } else if (p < content.problems.size()) {
      if (!one.ablation && !one.unsolved.empty()) {
        content.warnings.emplace_back(one.problem, fmt::format("{}: {}", one.strategy, one.unsolved));
      }
      content.cells[p][s].summary = std::move(one.summary);
      content.cells[p][s].verdicts = std::move(one.verdicts);
      content.cells[p][s].parts = std::move(one.parts);
    }
  }
}

void add_runs(HtmlContent& content, const Json& runs) {
  for (const Json& run : runs) {
    const auto p = std::find(content.problems.begin(), content.problems.end(), run.at("problem").get<std::string>());
    const auto strategy = run.at("strategy").get<std::string>();
    const auto s = std::find_if(content.strategies.begin(), content.strategies.end(),
                                [&](const HtmlStrategy& known) { return known.name == strategy; });
    if (p == content.problems.end() || s == content.strategies.end()) continue;
    HtmlCell& cell = content.cells[static_cast<std::size_t>(p - content.problems.begin())]
                                  [static_cast<std::size_t>(s - content.strategies.begin())];
    cell.runs.emplace(run.at("seed").get<std::uint64_t>(), outcome_of(run));
  }
}

}  // namespace

HtmlContent stored_html_content(const std::string& document, const std::string& file) {
  HtmlContent content;
  content.costs.add(document, file);
  std::vector<StoredSummary> summaries = read_stored_summaries(document, file);
  if (summaries.empty()) {
    throw Error(
        fmt::format("{}: its runs have no summary, as those of a sweep, so there is no page to make of them", file));
  }
  try {
    const Json json = Json::parse(document);
    const Json& experiment = json.at("experiment");
    content.script = json.at("script").get<std::string>();
    content.seeds = experiment.at("seeds").get<std::vector<std::uint64_t>>();
    for (const CostData::Problem& problem : content.costs.problems) content.problems.push_back(problem.name);
    for (const CostData::Strategy& one : content.costs.strategies) {
      content.strategies.push_back({one.name, one.text, one.ablation});
    }
    content.cells.assign(content.problems.size(), std::vector<HtmlCell>(content.strategies.size()));
    const Json& measure = experiment.at("measure");
    content.measured = !measure.is_null();
    content.about = html_about(content.problems.size(), content.strategies.size(), content.seeds,
                               content.measured ? string_or_empty(measure, "text") : "",
                               json.at("trellis").at("version").get<std::string>());
    add_summaries(content, std::move(summaries));
    for (const Json& warning : json.at("warnings")) {
      if (!warning.at("problem").is_string()) continue;
      content.warnings.emplace_back(warning.at("problem").get<std::string>(),
                                    "warning: " + warning.at("text").get<std::string>());
    }
    add_runs(content, json.at("runs"));
  } catch (const Json::exception&) {
    throw Error(fmt::format("{}: this is no document that trellis run --json writes", file));
  }
  // By problem, as the page of the run lists them.
  std::stable_sort(content.warnings.begin(), content.warnings.end(), [&](const auto& a, const auto& b) {
    const auto place = [&](const std::string& name) {
      return std::find(content.problems.begin(), content.problems.end(), name);
    };
    return place(a.first) < place(b.first);
  });
  content.costs = content.costs.without_ablations();
  content.costs.baseline = content.costs.reference();
  return content;
}

}  // namespace trellis
