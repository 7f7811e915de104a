// SPDX-License-Identifier: GPL-3.0-or-later
// Costs beside a reference: from the documents of runs to ratios, tables and pictures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/report.hpp>
#include "report_folder.hpp"
#include "support/catch.hpp"
#include "support/golden.hpp"

using namespace trellis;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Made {
  std::string strategy;
  std::string text;
  std::vector<double> checks;  ///< of seeds 1, 2, ...; below 0: no path, having spent as much
};

/// A document as `trellis run --json` writes it, of one problem; what costs do not need is left out.
std::string document(const std::string& problem, const std::string& group, bool tuned, const std::vector<Made>& made) {
  std::string strategies;
  std::string runs;
  for (const Made& one : made) {
    strategies +=
        fmt::format(R"({}{{"name": "{}", "text": "{}"}})", strategies.empty() ? "" : ",", one.strategy, one.text);
    for (std::size_t i = 0; i < one.checks.size(); ++i) {
      runs += fmt::format(
          R"({}{{"problem": "{}", "strategy": "{}", "seed": {}, "solved": {}, "validity_checks": {}, "cpu_s": {}}})",
          runs.empty() ? "" : ",", problem, one.strategy, i + 1, one.checks[i] >= 0.0, std::abs(one.checks[i]),
          0.001 * std::abs(one.checks[i]));
    }
  }
  return fmt::format(
      R"({{"experiment": {{"baseline": "connect", "problems": [{{"name": "{}", "group": "{}", "tuned": {}}}],)"
      R"( "strategies": [{}]}}, "runs": [{}]}})",
      problem, group, tuned, strategies, runs);
}

CostData two_worlds() {
  const auto made = [](double scale) {
    const auto times = [&](double factor) {
      std::vector<double> checks;
      for (int i = 0; i < 8; ++i) checks.push_back(scale * factor * (100 + i));
      return checks;
    };
    std::vector<double> failing = times(2.0);
    failing[0] = -failing[0];
    return std::vector<Made>{{"connect", "rrt_connect()", times(1.0)},
                             {"rrt", "rrt()", times(4.0)},
                             {"a", "skeleton() >> rrt()", times(0.5 * scale)},
                             {"b", "shrink(0.5) >> rrt()", failing},
                             {"ab", "skeleton() >> shrink(0.5) >> rrt()", times(1.0)}};
  };
  CostData data;
  data.add(document("cup", "paper", true, made(1.0)), "cup.json");
  data.add(document("a|b", "held", false, made(8.0)), "other.json");
  return data;
}

const CostComparison& find(const CostData& data, const std::vector<CostComparison>& all, const std::string& problem,
                           const std::string& strategy) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const CostComparison& c) {
    return data.problems[c.problem].name == problem && data.strategies[c.strategy].name == strategy;
  });
  REQUIRE(found != all.end());
  return *found;
}

}  // namespace

TEST_CASE("a strategy's text is split into its levels", "[report][costs]") {
  using Levels = std::vector<std::string>;
  CHECK(cost_levels("rrt()") == Levels{"rrt()"});
  CHECK(cost_levels("skeleton() >> shrink(0.5) >> rrt { step = 0.5 }") ==
        Levels{"skeleton()", "shrink(0.5)", "rrt { step = 0.5 }"});
  CHECK(cost_levels("(skeleton() >> lazy()) + lazy() >> rrt()") == Levels{"(skeleton() >> lazy()) + lazy()", "rrt()"});
  CHECK(cost_levels("shrink { 0.5, planner = lazy() >> rrt() } >> rrt()").size() == 2);
  CHECK(cost_levels("experience { file = \"a >> (b\" } >> rrt()").size() == 2);
}

TEST_CASE("costs are divided seed by seed, and a run without a path costs infinitely much", "[report][costs]") {
  CostData data;
  data.add(document("cup", "", false,
                    {{"connect", "rrt_connect()", {100, 200, -400, 100, 100, 100}},
                     {"a", "skeleton() >> rrt_connect()", {50, 50, 100, -10, 200, 300}}}),
           "cup.json");
  CHECK(data.baseline == "connect");
  const auto all = compare_costs(data, CostReference::baseline, "connect");
  REQUIRE(all.size() == 1);
  CHECK(all[0].runs == 6);
  CHECK(all[0].solved == 5);
  CHECK(all[0].checks.reference_solved == 5);
  CHECK(all[0].checks.both_solved == 4);
  // 0.5, 0.25, 0 (the reference failed), infinite, 2, 3.
  CHECK(all[0].checks.ratio.value == 1.25);
  CHECK(all[0].checks.median.value == 150.0);
  CHECK(all[0].checks.reference_median.value == 100.0);
  CHECK(all[0].checks.ratio_of_medians() == 1.5);
  CHECK(std::isnan(all[0].checks.ratio_of_totals()));  // each side left a run unsolved
  // Six seeds bound nothing with 99 %.
  CHECK(all[0].checks.ratio.lo == 0.0);
  CHECK(all[0].checks.ratio.hi == infinity);
  CHECK(all[0].seconds.ratio.value == Approx(1.25));
  CHECK(all[0].seconds.median.value == Approx(0.15));
}

TEST_CASE("a composition is compared with the part that costs less there", "[report][costs]") {
  const CostData data = two_worlds();
  const auto parts = compare_costs(data, CostReference::best_part, "connect");
  CHECK(parts.size() == 2);
  CHECK(find(data, parts, "cup", "ab").checks.reference == "a");
  CHECK(find(data, parts, "cup", "ab").checks.ratio.value == 2.0);
  CHECK(find(data, parts, "a|b", "ab").checks.reference == "b");
  const auto own = compare_costs(data, CostReference::own_planner, "connect");
  CHECK(own.size() == 6);
  CHECK(std::all_of(own.begin(), own.end(), [](const auto& c) { return c.checks.reference == "rrt"; }));
  CHECK(find(data, own, "a|b", "a").checks.ratio.value == 1.0);

  const std::size_t b = 3;
  const auto beside = compare_costs(data, CostReference::baseline, "connect");
  const CostSummary summary = summarise_costs(data, beside, b, &CostComparison::checks);
  CHECK(summary.problems == 2);
  CHECK(summary.runs == 16);
  CHECK(summary.solved == 14);
  CHECK(summarise_costs(data, beside, b, &CostComparison::checks, true).problems == 1);
  CHECK(summarise_costs(data, beside, 2, &CostComparison::checks).worst_problem == "a|b");
  CHECK(summarise_costs(data, beside, 2, &CostComparison::checks, true).worst == 0.5);
}

TEST_CASE("documents that do not fit are refused by name", "[report][costs]") {
  CostData data;
  CHECK_THROWS_WITH(data.add("{}", "empty.json"), "empty.json: this is no document that trellis run --json writes");
  CHECK_THROWS_WITH(data.add("<html>", "page.html"), "page.html: this is no document that trellis run --json writes");
  const std::string one = document("cup", "", false, {{"connect", "rrt_connect()", {1}}});
  data.add(one, "one.json");
  CHECK_THROWS_WITH(data.add(one, "again.json"), "again.json: seed 1 of 'connect' on 'cup' is there twice");
  CHECK_THROWS_WITH(data.add(document("trap", "", false, {{"connect", "rrt()", {1}}}), "two.json"),
                    "two.json: 'connect' is rrt() here and rrt_connect() in another file");
  CHECK_THROWS_WITH(compare_costs(data, CostReference::baseline, "conect"),
                    "there is no strategy 'conect' (did you mean 'connect'?); there are: connect");
}

TEST_CASE("a document without CPU times has ratios of checks only", "[report][costs]") {
  std::string text = document("cup", "", false, {{"connect", "rrt_connect()", {1, 2}}, {"rrt", "rrt()", {2, 4}}});
  for (auto at = text.find("cpu_s"); at != std::string::npos; at = text.find("cpu_s")) text.replace(at, 5, "other");
  CostData data;
  data.add(text, "old.json");
  const auto all = compare_costs(data, CostReference::baseline, "connect");
  REQUIRE(all.size() == 1);
  CHECK(all[0].checks.ratio.value == 2.0);
  CHECK(std::isnan(all[0].seconds.ratio.value));
  CHECK_FALSE(costs_markdown(data, "connect").empty());
}

TEST_CASE("the tables of costs", "[report][costs]") {
  const CostData data = two_worlds();
  test::check_golden("costs.md", costs_markdown(data, "connect"));
  test::check_golden("costs.txt", costs_text(data, "connect", 120));
  test::check_golden("costs.csv", costs_csv(data, "connect"));
}

TEST_CASE("the pictures of costs are drawn where there is something to draw", "[report][costs]") {
  const fixture::Folder folder;
  const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
  write_cost_figures(two_worlds(), "connect", path("all"));
  for (const std::string name : {"baseline", "own_planner", "parts"}) {
    for (const std::string format : {"svg", "png", "pdf"}) {
      CHECK(std::filesystem::file_size(path("all/" + name + "." + format)) > 1000);
    }
  }
  CostData few;
  few.add(document("cup", "", false, {{"connect", "rrt_connect()", {1, 2}}, {"rrt", "rrt()", {2, -4}}}), "few.json");
  write_cost_figures(few, "connect", path("few"));
  CHECK(std::filesystem::exists(path("few/baseline.svg")));
  CHECK_FALSE(std::filesystem::exists(path("few/parts.svg")));
}
