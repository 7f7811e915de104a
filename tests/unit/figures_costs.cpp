// SPDX-License-Identifier: GPL-3.0-or-later
// Costs relative to a reference: from the documents of runs to ratios, tables and pictures.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/figures/charts/costs_figures.hpp>
#include <trellis/report/cost_correlation.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/parameter_sweeps.hpp>
#include <trellis/report/records.hpp>
#include <trellis/report/report.hpp>
#include "report_fixture.hpp"
#include "report_folder.hpp"
#include "support/catch.hpp"
#include "support/golden.hpp"

using namespace trellis;

namespace {

void add(CostData& data, const std::string& document, const std::string& file) {
  const ExperimentFacts facts = read_results(document, file);
  data.add(facts, summarise(facts), file);
}

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
      for (int i = 0; i < 8; ++i) checks.push_back(2.0 * scale * factor * (100 + i));
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
  add(data, document("cup", "paper", true, made(1.0)), "cup.json");
  add(data, document("a|b", "new", false, made(8.0)), "other.json");
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
  add(data,
      document("cup", "", false,
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
  // The interval of six seeds has all of them.
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
  CHECK_THROWS_WITH(add(data, "{}", "empty.json"), "empty.json: this is no document that trellis run --json writes");
  CHECK_THROWS_WITH(add(data, "<html>", "page.html"), "page.html: this is no document that trellis run --json writes");
  const std::string one = document("cup", "", false, {{"connect", "rrt_connect()", {1}}});
  add(data, one, "one.json");
  CHECK_THROWS_WITH(add(data, one, "again.json"), "again.json: seed 1 of 'connect' on 'cup' is there twice");
  CHECK_THROWS_WITH(
      add(data, document("trap", "", false, {{"connect", "rrt()", {1}}}), "two.json"),
      "two.json: 'connect' is rrt() here and rrt_connect() in another file; --by-name compares strategies "
      "by their names alone");
  CHECK_THROWS_WITH(compare_costs(data, CostReference::baseline, "conect"),
                    "there is no strategy 'conect' (did you mean 'connect'?); there are: connect");
}

TEST_CASE("strategies whose options differ between documents are compared by name where that is asked for",
          "[report][costs]") {
  CostData data;
  data.by_name = true;
  add(data,
      document("small", "", false, {{"connect", "rrt_connect { step = 1 }", {4}}, {"rrt", "rrt { step = 1 }", {8}}}),
      "small.json");
  add(data,
      document("large", "", false, {{"connect", "rrt_connect { step = 9 }", {2}}, {"rrt", "rrt { step = 9 }", {1}}}),
      "large.json");
  REQUIRE(data.strategies.size() == 2);
  CHECK(data.strategies[0].text == "rrt_connect { step = 1 }");
  CHECK(data.runs.size() == 4);
  const auto beside = compare_costs(data, CostReference::baseline, "connect");
  const CostSummary summary = summarise_costs(data, beside, 1, &CostComparison::checks);
  CHECK(summary.problems == 2);
  CHECK(summary.worst == 2.0);
}

TEST_CASE("a document without CPU times has ratios of checks only", "[report][costs]") {
  std::string text = document("cup", "", false, {{"connect", "rrt_connect()", {1, 2}}, {"rrt", "rrt()", {2, 4}}});
  for (auto at = text.find("cpu_s"); at != std::string::npos; at = text.find("cpu_s")) text.replace(at, 5, "other");
  CostData data;
  add(data, text, "old.json");
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
  add(few, document("cup", "", false, {{"connect", "rrt_connect()", {1, 2}}, {"rrt", "rrt()", {2, -4}}}), "few.json");
  for (const std::string name : {"cup/success", "a-b/success"}) {
    for (const std::string format : {"svg", "png", "pdf"}) {
      CHECK(std::filesystem::file_size(path("all/" + name + "." + format)) > 1000);
    }
  }
  // No planner there improves its path.
  CHECK_FALSE(std::filesystem::exists(path("all/cup/length.svg")));
  write_cost_figures(few, "connect", path("few"));
  CHECK(std::filesystem::exists(path("few/baseline.svg")));
  CHECK_FALSE(std::filesystem::exists(path("few/parts.svg")));
}

namespace {

/// One strategy on one problem, whose runs found paths of these lengths at these checks; none: the run found no path.
CostData anytime(const std::vector<std::vector<std::pair<double, double>>>& runs) {
  CostData data;
  data.baseline = "rrt";
  data.problems = {{"cup", "", false}};
  data.strategies = {{"star", "rrt_star()"}, {"rrt", "rrt()"}};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    CostData::Run run{0, 0, i + 1, !runs[i].empty(), 1000.0, 1.0, {}};
    for (const auto& [checks, length] : runs[i]) {
      run.improvements.push_back({static_cast<std::uint64_t>(checks), 1e-3 * checks, length});
    }
    data.runs.push_back(run);
  }
  return data;
}

}  // namespace

TEST_CASE("a curve of success counts the runs that found a path within each cost", "[report][costs]") {
  const CostData data = two_worlds();
  const auto strategy = [&](const std::string& name) {
    for (std::size_t s = 0; s < data.strategies.size(); ++s) {
      if (data.strategies[s].name == name) return s;
    }
    return data.strategies.size();
  };
  const SuccessCurve failing = success_curve(data, 0, strategy("b"), CostKind::checks);
  CHECK(failing.runs == 8);
  CHECK(failing.at == std::vector<double>{404, 408, 412, 416, 420, 424, 428});
  REQUIRE(failing.share.size() == 7);
  for (std::size_t i = 0; i < 7; ++i) {
    const Interval expected = wilson_interval(i + 1, 8);
    CHECK(failing.share[i].value == expected.value);
    CHECK(failing.share[i].lo == expected.lo);
    CHECK(failing.share[i].hi == expected.hi);
  }
  CHECK(failing.spent == 428.0);
  CHECK(success_curve(data, 0, strategy("rrt"), CostKind::seconds).at.front() == Approx(0.8));

  // Runs with equal costs of their paths are one step; an anytime run had its path before it ended.
  const CostData going_on = anytime({{{100, 12.0}, {600, 11.0}}, {{100, 13.0}}, {}});
  const SuccessCurve curve = success_curve(going_on, 0, 0, CostKind::checks);
  CHECK(curve.at == std::vector<double>{100});
  CHECK(curve.share[0].value == Approx(2.0 / 3));
  CHECK(curve.spent == 1000.0);
}

TEST_CASE("a curve of length is the median of the shortest paths known", "[report][costs]") {
  const CostData data = anytime({{{100, 14.0}, {300, 11.0}}, {{200, 13.0}}, {{100, 12.0}, {400, 10.0}}});
  const LengthCurve curve = length_curve(data, 0, 0, CostKind::checks);
  CHECK(curve.improves);
  CHECK(curve.at == std::vector<double>{100, 200, 300, 400});
  REQUIRE(curve.length.size() == 4);
  CHECK(curve.length[0].value == 14.0);  // the run without a path is infinite: 12, 14, inf
  CHECK(curve.length[1].value == 13.0);
  CHECK(curve.length[2].value == 12.0);
  CHECK(curve.length[3].value == 11.0);
  CHECK(length_curve(data, 0, 0, CostKind::seconds).at == std::vector<double>{0.1, 0.2, 0.3, 0.4});
  // A run without a path at all: two of four are infinite at first.
  const CostData late = anytime({{{100, 14.0}}, {{200, 13.0}}, {{300, 12.0}}, {}});
  CHECK(std::isinf(length_curve(late, 0, 0, CostKind::checks).length[0].value));
  CHECK_FALSE(length_curve(late, 0, 0, CostKind::checks).improves);
}

TEST_CASE("figures of curves have a panel for checks and one for time, and each strategy's colour", "[report][costs]") {
  const CostData data = two_worlds();
  const auto success = success_figure(data, "connect", 0);
  REQUIRE(success);
  REQUIRE(success->panels.size() == 4);  // the baseline and three others, the baseline and the last one
  CHECK(success->caption == "8 runs of each strategy; bands: 95 % Wilson interval of the share.");
  for (const draw::Panel& panel : success->panels) {
    REQUIRE(panel.series.size() >= 2);
    CHECK(panel.series.front().name == "connect");
    CHECK(*panel.series.front().colour == draw::palette::baseline);
    for (const draw::Series& series : panel.series) {
      CHECK(series.x.size() == series.y.size() + 1);
      CHECK(series.lo.size() == series.y.size());
      CHECK(std::is_sorted(series.x.begin(), series.x.end()));
      CHECK(std::is_sorted(series.y.begin(), series.y.end()));
      CHECK(series.y.front() == 0.0);
    }
  }
  CHECK_FALSE(length_figure(data, "connect", 0));
  const auto length = length_figure(anytime({{{100, 14.0}, {300, 11.0}}, {{200, 13.0}}}), "rrt", 0);
  REQUIRE(length);
  CHECK(length->panels.size() == 2);
  CHECK(length->panels[0].series.size() == 1);
  // Where no run found a path there is nothing to draw.
  CHECK_FALSE(success_figure(anytime({{}, {}}), "rrt", 0));
  for (std::size_t i = 0; i < data.strategies.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      CHECK_FALSE(strategy_colour(data, "connect", i) == strategy_colour(data, "connect", j));
    }
  }
}

TEST_CASE("all panels of a quantity have one axis, and panels and curves can be chosen", "[report][costs]") {
  const CostData data = two_worlds();
  const auto both = success_figure(data, "connect", 0);
  REQUIRE(both);
  REQUIRE(both->panels.size() == 4);
  CHECK(both->columns == 2);
  for (const std::size_t column : {0U, 1U}) {
    const draw::Panel& first = both->panels[column];
    const draw::Panel& second = both->panels[column + 2];
    CHECK(first.x.label == second.x.label);
    REQUIRE((first.x.lo && first.x.hi));
    CHECK(second.x.lo == first.x.lo);
    CHECK(second.x.hi == first.x.hi);
    for (const draw::Panel& panel : {first, second}) {
      for (const draw::Series& series : panel.series) {
        CHECK(series.x.front() == *first.x.lo);
        CHECK(series.x.back() == *first.x.hi);
      }
    }
  }
  const auto checks = success_figure(data, "connect", 0, {.seconds = false});
  REQUIRE(checks);
  CHECK(checks->panels.size() == 2);
  CHECK(checks->columns == 1);
  CHECK(checks->panels[1].x.label == both->panels[0].x.label);
  const auto time = success_figure(data, "connect", 0, {.checks = false, .curves = 10});
  REQUIRE(time);
  REQUIRE(time->panels.size() == 1);
  CHECK(time->panels[0].series.size() == data.strategies.size());
  CHECK(time->panels[0].x.label == both->panels[1].x.label);
  const auto ratios = ratio_figure(data, "connect", {.checks = false});
  REQUIRE(ratios);
  CHECK(ratios->panels == std::vector<std::string>{"CPU time"});
  CHECK(ratios->rows[0].panels.size() == 1);
}

namespace {

/// Strategies that differ in one number, one of which never finds a path, beside one without a guide.
CostData swept() {
  CostData data;
  data.baseline = "connect";
  data.problems = {{"cup", "", false}, {"trap", "", false}};
  data.strategies = {{"connect", "rrt_connect()", false, R"({"planner": "rrt_connect", "options": {"step": 0.5}})"}};
  const std::vector<std::pair<double, double>> factors = {{0.9, 4.0}, {0.5, 0.5}, {0.25, 1.0}, {0.1, -1.0}};
  for (const auto& [scale, factor] : factors) {
    data.strategies.push_back(
        {fmt::format("s{}", scale), fmt::format("shrink({}) >> rrt_connect()", scale), false,
         fmt::format(R"({{"planner": "rrt_connect", "options": {{"step": 0.5}}, )"
                     R"("guided_by": {{"guide": "shrink", "options": {{"scale": {}, "paths": 1}}}}}})",
                     scale)});
  }
  for (const std::size_t problem : {0U, 1U}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const double cost = 100.0 + static_cast<double>(seed);
      data.runs.push_back({problem, 0, seed, true, cost, 1e-3 * cost});
      for (std::size_t i = 0; i < factors.size(); ++i) {
        const double factor = factors[i].second;
        data.runs.push_back(
            {problem, i + 1, seed, factor > 0.0, std::abs(factor) * cost, 1e-3 * std::abs(factor) * cost});
      }
    }
  }
  return data;
}

}  // namespace

TEST_CASE("strategies that differ in one number of one option are a sweep", "[report][costs]") {
  CostData data = swept();
  const auto sweeps = parameter_sweeps(data);
  REQUIRE(sweeps.size() == 1);
  CHECK(sweeps[0].option == "scale of shrink");
  REQUIRE(sweeps[0].curves.size() == 1);
  CHECK(sweeps[0].curves[0].values == std::vector<double>{0.1, 0.25, 0.5, 0.9});
  CHECK(sweeps[0].curves[0].strategies == std::vector<std::size_t>{4, 3, 2, 1});
  CHECK(sweeps[0].curves[0].name == "shrink(scale) >> rrt_connect()");
  CHECK(sweeps[0].has(1));
  CHECK_FALSE(sweeps[0].has(0));
  // Where another option differs too, a strategy is another curve; two values are no sweep.
  for (const std::size_t s : {1U, 2U})
    data.strategies[s].spec.replace(data.strategies[s].spec.find("paths\": 1"), 9, "paths\": 2");
  CHECK(parameter_sweeps(data).empty());
  CHECK(parameter_sweeps(two_worlds()).empty());
}

TEST_CASE("a sweep is drawn over its number with intervals, and is not in the figure of ratios", "[report][costs]") {
  const CostData data = swept();
  const auto figures = sweep_figures(data.on(0), "connect");
  REQUIRE(figures.size() == 1);
  const draw::Figure& figure = figures[0];
  REQUIRE(figure.panels.size() == 3);
  CHECK(figure.panels[0].x.label == "scale of shrink");
  CHECK(figure.panels[0].x.categories.empty());
  const auto points = [](const draw::Panel& panel) {
    const auto found = std::find_if(panel.series.begin(), panel.series.end(),
                                    [](const auto& s) { return s.kind == draw::Series::Kind::points; });
    REQUIRE(found != panel.series.end());
    return *found;
  };
  for (const std::size_t quantity : {0U, 1U}) {
    const draw::Series costs = points(figure.panels[quantity]);
    CHECK(costs.x == std::vector<double>{0.1, 0.25, 0.5, 0.9});
    CHECK(costs.y[0] == infinity);
    CHECK(costs.y[1] == Approx(1.0));
    CHECK(costs.y[2] == Approx(0.5));
    CHECK(costs.lo[2] == Approx(0.5));
    CHECK(costs.hi[3] == Approx(4.0));
    REQUIRE(figure.panels[quantity].references.size() == 1);
    CHECK(figure.panels[quantity].references[0].y == 1.0);
  }
  const draw::Series solved = points(figure.panels[2]);
  CHECK(solved.y == std::vector<double>{0.0, 100.0, 100.0, 100.0});
  CHECK(solved.hi[0] == Approx(100.0 * wilson_interval(0, 10).hi));
  CHECK_FALSE(ratio_figure(data, "connect"));

  // Without a baseline the costs themselves; over several problems a curve for each.
  const auto plain = sweep_figures(data, "", {.seconds = false});
  REQUIRE(plain.size() == 1);
  REQUIRE(plain[0].panels.size() == 2);
  CHECK(plain[0].panels[0].series.size() == 4);
  CHECK(points(plain[0].panels[0]).name == "cup");
  CHECK(points(plain[0].panels[0]).y[2] == Approx(0.5 * 105.5));
  const fixture::Folder folder;
  write_figure(plain[0], {}, (folder.path() / "sweep").string());
  fixture::check_pictures(folder);
}

namespace {

/// Costs of guided strategies with nats: by mass as `mass` has it, by hitting half a nat more, by spread 0.1 less for
/// each further strategy. \param ratios  of each problem and strategy, to the baseline; infinite: no path
CostData with_nats(const std::vector<std::vector<double>>& ratios, const std::vector<std::vector<double>>& mass) {
  CostData data;
  data.baseline = "rrt";
  data.strategies = {{"rrt", "rrt()"}};
  for (std::size_t s = 0; s < ratios.front().size(); ++s) {
    data.strategies.push_back({fmt::format("s{}", s), fmt::format("shrink(0.{}) >> rrt()", s + 1)});
  }
  constexpr std::uint64_t seeds = 3;
  for (std::size_t p = 0; p < ratios.size(); ++p) {
    data.problems.push_back({fmt::format("world {}", p), ""});
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      data.runs.push_back({p, 0, seed, true, 100.0, 0.1});
      for (std::size_t s = 0; s < ratios[p].size(); ++s) {
        if (std::isnan(ratios[p][s])) continue;
        const bool solved = std::isfinite(ratios[p][s]);
        data.runs.push_back({p, s + 1, seed, solved, solved ? 100.0 * ratios[p][s] : 500.0, 0.1});
      }
    }
    for (std::size_t s = 0; s < mass[p].size(); ++s) {
      if (std::isnan(mass[p][s])) continue;
      const double spread = -0.1 * static_cast<double>(s);
      data.nats.push_back({p, s + 1, false, true, seeds, mass[p][s], spread, mass[p][s] + spread, mass[p][s] + 0.5});
    }
  }
  return data;
}

constexpr double none = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("the nats that order the checks within each problem have a correlation of -1", "[report][costs]") {
  // By mass the first strategy is the best everywhere; problems differ more than strategies do.
  const CostData data = with_nats(
      {{0.1, 0.5, 2.0}, {10, 20, 30}, {1, 2, infinity}, {0.01, 0.02, 0.03}, {3, 4, 5}, {6, 7, 8}},
      {{2.0, 1.5, 1.0}, {7.0, 6.5, 6.1}, {0.3, 0.1, -0.5}, {2.0, 1.9, 1.0}, {3.0, 2.0, 1.0}, {2.0, 1.0, 0.0}});
  const auto found = cost_correlation(data, "rrt");
  REQUIRE(found);
  CHECK(found->dots.size() == 18);
  CHECK(found->problems == 6);
  CHECK(found->strategies == 3);
  CHECK(found->cross == 6);
  CHECK(found->dots[8].ratio == infinity);
  for (const Interval& rho : found->rho) {
    CHECK(rho.value == Approx(-1.0));
    CHECK(rho.hi == Approx(-1.0));
    CHECK(rho.n == 6);
  }
  CHECK(found->differences[0].value == Approx(0.0));
  CHECK(correlation_text(found->rho[0]) == "-1.00 [-1.00, -1.00]");
  const auto rows = correlation_rows(data, "rrt");
  REQUIRE(rows.size() == 10);
  CHECK(rows[1][0] == "hitting");
  CHECK(rows[5][0] == "hitting - mass");
  CHECK(rows[8] == std::array<std::string, 3>{"mass - SE", "+0.00 [+0.00, +0.00]", "-"});

  const auto figure = correlation_figure(data, "rrt");
  REQUIRE(figure);
  REQUIRE(figure->panels.size() == 4);
  CHECK(figure->panels[0].title.starts_with("hitting\n"));
  CHECK(figure->panels[1].title == "mass\nρ = -1.00 [-1.00, -1.00]");
  CHECK(figure->panels[3].title.starts_with("SE\n"));
  REQUIRE(figure->panels[0].series.size() == 6);
  CHECK(figure->panels[0].series[2].name == "world 2");
  CHECK(figure->panels[1].series[2].x == std::vector{0.3, 0.1, -0.5});
  CHECK(figure->panels[2].series[2].x == std::vector{0.0, -0.1, -0.2});
  CHECK(figure->panels[0].series[2].y == std::vector{1.0, 2.0, infinity});
  CHECK(figure->caption.starts_with("Nodes of the root. 3 strategies with guides on 6 problems, 18 pairs of both: "));
  const fixture::Folder folder;
  write_figure(*figure, {}, (folder.path() / "correlation").string());
  fixture::check_pictures(folder);

  const std::string text = costs_text(data, "rrt", 120);
  CHECK(text.find("mass - spread") != std::string::npos);
  const std::string table = costs_markdown(data, "rrt");
  CHECK(table.find("## Rank correlation of efficiency and checks") != std::string::npos);
  CHECK(table.find("| mass | -1.00 [-1.00, -1.00] | - |\n| spread | -1.00") != std::string::npos);
}

TEST_CASE("a reversed order has a correlation of 1, and mass and spread may disagree", "[report][costs]") {
  // The last strategy has the most by mass, by far, and the least by spread.
  const std::vector<double> mass = {1.0, 2.0, 3.0};
  const auto found = cost_correlation(with_nats({{1, 2, 3}, {2, 4, 8}}, {mass, mass}), "rrt");
  REQUIRE(found);
  CHECK(found->rho[0].value == Approx(1.0));
  CHECK(found->rho[1].value == Approx(1.0));
  CHECK(found->rho[2].value == Approx(-1.0));
  CHECK(found->rho[3].value == Approx(1.0));
  CHECK(found->differences[2].value == Approx(2.0));
  CHECK(std::isnan(found->rho[0].lo));  // two problems have no interval
  CHECK(correlation_text(found->rho[0]) == "+1.00");
  CHECK(correlation_explanation(*found, "rrt").find("bootstrap") == std::string::npos);
  // The orders of two problems are opposite: together none.
  const auto neither = cost_correlation(with_nats({{1, 2, 3}, {8, 4, 2}}, {mass, mass}), "rrt");
  REQUIRE(neither);
  CHECK(neither->rho[0].value == Approx(0.0));
}

TEST_CASE("a correlation leaves out what has no nats or no ratio, and needs three strategies on two problems",
          "[report][costs]") {
  const std::vector<double> mass = {1.0, 2.0, 3.0, 4.0};
  const auto correlate = [](const CostData& data) { return cost_correlation(data, "rrt"); };
  const auto some = correlate(with_nats({{1, 2, 3, none}, {1, 2, 3, 4}}, {mass, {none, 2.0, 3.0, 4.0}}));
  REQUIRE(some);
  CHECK(some->dots.size() == 6);
  CHECK_FALSE(correlate(with_nats({{1, 2, 3, none}, {1, 2, 3, 4}}, {mass, {none, none, 3.0, 4.0}})));
  CHECK_FALSE(correlate(with_nats({{1, 2, 3, 4}}, {mass})));
  CHECK_FALSE(correlation_figure(with_nats({{1, 2, 3, 4}}, {mass}), "rrt"));
  // Ratios that are all infinite have no order.
  const auto infinite = correlate(with_nats({{infinity, infinity, infinity}, {1, 2, 3}}, {mass, mass}));
  REQUIRE(infinite);
  CHECK(infinite->rho[0].n == 1);
  CHECK(infinite->rho[0].value == Approx(1.0));
  // Neither an ablation nor a strategy without guides is one with guides.
  CostData data = with_nats({{1, 2, 3}, {1, 2, 3}}, {mass, mass});
  CHECK(correlate(data));
  CHECK_FALSE(cost_correlation(data, ""));
  CHECK_FALSE(cost_correlation(data, "s0"));
  data.strategies[1].ablation = true;
  CHECK_FALSE(correlate(data));
  CHECK(costs_text(data, "rrt", 120).find("rank correlation") == std::string::npos);
  CHECK(costs_markdown(data, "rrt").find("Rank correlation") == std::string::npos);
}

TEST_CASE("nats are on other seeds' paths where a problem has any, and are averaged over the runs of all documents",
          "[report][costs]") {
  const std::vector<double> mass = {1.0, 2.0, 3.0};
  CostData data = with_nats({{1, 2, 3}, {1, 2, 3}}, {mass, mass});
  data.nats.push_back({0, 1, false, false, 3, 9.0, 0.0, 9.0});  // on its own path
  data.nats.push_back({0, 1, false, true, 9, 5.0, 0.0, 5.0});   // of another document
  const auto found = cost_correlation(data, "rrt");
  REQUIRE(found);
  CHECK(found->dots[0].nats[1] == Approx((3.0 * 1.0 + 9.0 * 5.0) / 12.0));
  // Those of the proposals are correlated by themselves.
  CHECK_FALSE(cost_correlation(data, "rrt", true));
  CostData both = data;
  for (CostData::Nats one : data.nats) {
    one.proposals = true;
    one.mass = -one.mass;
    both.nats.push_back(one);
  }
  const auto proposals = cost_correlation(both, "rrt", true);
  REQUIRE(proposals);
  CHECK(proposals->rho[1].value == Approx(-cost_correlation(both, "rrt")->rho[1].value));
  for (CostData::Nats& one : data.nats) one.cross = one.cross && one.problem == 0;
  const auto mixed = cost_correlation(data, "rrt");
  REQUIRE(mixed);
  CHECK(mixed->cross == 1);
  CHECK(correlation_explanation(*mixed, "rrt").find("other seeds' paths in 1 of 2 problems, else its own") !=
        std::string::npos);
}

TEST_CASE("a figure of ratios says of how many pairs its medians are", "[report][costs]") {
  const CostData data = two_worlds();
  const auto all = ratio_figure(data, "connect");
  REQUIRE(all);
  CHECK(all->rows.size() == 4);
  CHECK(all->rows[0].panels[0].size() == 2);
  CHECK(all->caption.find("over 8 pairs of runs") != std::string::npos);
  const auto one = ratio_figure(data.on(1), "connect");
  REQUIRE(one);
  REQUIRE(one->rows[0].panels[0].size() == 1);
  // "rrt" costs four times as much on every seed.
  CHECK(one->rows[0].panels[0][0].value == 4.0);
  CHECK(one->rows[0].panels[0][0].text == "4.00 [4.00, 4.00]");
  CHECK_FALSE(ratio_figure(data, ""));
}

TEST_CASE("the costs of an experiment are those of its document", "[report][costs]") {
  auto [experiment, result] = fixture::passage();
  for (RunResult& run : result.runs) {
    std::optional<Scores>& root = run.levels.front().root;
    if (!root) continue;
    for (Efficiency* e : {&root->tree, &root->expansion}) {
      e->parts.mass = 0.9 * e->value;
      e->parts.spread = 0.1 * e->value;
    }
    run.levels.front().own = root;
    run.levels.front().root_cross = root;
    run.levels.front().root_cross->tree.above_uniform -= 0.1;
  }
  CostData read;
  add(read, fixture::report_json(experiment, result, ""), "results.json");
  const CostData made = cost_data(facts_of(experiment, result), summarise(facts_of(experiment, result)));
  CHECK(made.baseline == "rrt");
  REQUIRE(made.runs.size() == read.runs.size());
  for (std::size_t i = 0; i < made.runs.size(); ++i) {
    CHECK(made.runs[i].strategy == read.runs[i].strategy);
    CHECK(made.runs[i].seed == read.runs[i].seed);
    CHECK(made.runs[i].solved == read.runs[i].solved);
    CHECK(made.runs[i].checks == read.runs[i].checks);
    CHECK(made.runs[i].improvements.size() == read.runs[i].improvements.size());
  }
  CHECK(made.nats.size() == 2 * 2 * 2);  // strategies, nodes and proposals, own paths and those of other seeds
  REQUIRE(made.nats.size() == read.nats.size());
  for (const CostData::Nats& one : made.nats) {
    const auto same = std::find_if(read.nats.begin(), read.nats.end(), [&](const CostData::Nats& other) {
      return other.problem == one.problem && other.strategy == one.strategy && other.cross == one.cross &&
             other.proposals == one.proposals;
    });
    REQUIRE(same != read.nats.end());
    CHECK(same->runs == one.runs);
    CHECK(same->mass == one.mass);
    CHECK(same->spread == one.spread);
    CHECK(same->above == one.above);
    CHECK(same->hitting == one.hitting);
  }
}

TEST_CASE("figures for papers have a column's width and their titles in a file of their own", "[report][costs]") {
  const fixture::Folder folder;
  const auto path = [&](const std::string& name) { return folder.path() / name; };
  const auto figure = success_figure(two_worlds(), "connect", 0);
  REQUIRE(figure);
  write_figure(*figure, {}, path("screen").string());
  write_figure(*figure, {.width = 240.0, .titles = false}, path("paper").string());
  write_figure(*figure, {.width = 240.0, .titles = false, .typeface = draw::Typeface::serif}, path("serif").string());
  CHECK_FALSE(std::filesystem::exists(path("screen.txt")));
  CHECK(fixture::read(path("paper.txt")) == figure->title + "\n\n" + figure->caption + "\n");
  CHECK(fixture::read(path("paper.svg")).find("width=\"240") != std::string::npos);
  CHECK(fixture::read(path("serif.svg")) != fixture::read(path("paper.svg")));
  fixture::check_pictures(folder);
}
