// SPDX-License-Identifier: GPL-3.0-or-later
// What a report says first, of constructed runs, and how it is laid out.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <trellis/report/experiment_summary.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/report/words.hpp>

#include "report_fixture.hpp"
#include "support/catch.hpp"

using namespace trellis;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// An experiment of which only the costs are given.
struct Costs {
  ExperimentFacts facts;

  Costs(const std::vector<std::string>& strategies, std::size_t problems, std::size_t seeds) {
    for (std::size_t i = 1; i <= seeds; ++i) facts.seeds.push_back(i);
    for (std::size_t p = 0; p < problems; ++p) facts.problems.push_back({.name = "world " + std::to_string(p + 1)});
    for (const std::string& name : strategies) facts.strategies.push_back({.name = name, .text = name});
  }
  /// \param checks  of a problem and a seed, both from 1; infinite: no path
  template <class Checks>
  void run(const std::string& strategy, const Checks& checks) {
    for (std::size_t p = 0; p < facts.problems.size(); ++p) {
      for (const std::uint64_t seed : facts.seeds) {
        RunFacts one;
        one.problem = facts.problems[p].name;
        one.strategy = strategy;
        one.seed = seed;
        const double spent = checks(p + 1, seed);
        one.solved = std::isfinite(spent);
        one.validity_checks = one.solved ? static_cast<std::uint64_t>(spent) : 100'000;
        one.seconds = 1e-6 * static_cast<double>(one.validity_checks);
        one.length = 12.5;
        if (!one.solved) one.reasons = {"50000 proposals spent at level 0"};
        LevelFacts root;
        root.key = "0";
        root.name = "root";
        one.levels.push_back(root);
        facts.runs.push_back(std::move(one));
      }
    }
  }
  /// The costs of a strategy without a guide.
  template <class Without>
  void leave_out(const std::string& strategy, const std::string& guide, const Without& without) {
    const std::string key = "0/" + guide;
    for (StrategyFacts& one : facts.strategies) {
      if (one.name != strategy) continue;
      one.guided = true;
      one.guides.push_back({key, guide, ""});
    }
    for (std::size_t p = 0; p < facts.problems.size(); ++p) {
      LeftOut left{facts.problems[p].name, strategy, key, {}};
      for (const RunFacts* run : facts.select(facts.problems[p].name, strategy)) {
        left.pairs.push_back({run->seed, path_cost(*run), without(*run)});
      }
      facts.left_out.push_back(std::move(left));
    }
  }
  [[nodiscard]] ExperimentSummary summary() const { return summarise(facts); }
  [[nodiscard]] Answer answer() const { return summary().answer; }
  [[nodiscard]] std::string text(int width = 100) const { return report_text(summary(), width, ReportKind::overview); }
};

/// Checks that no line is wider.
void check_width(const std::string& text, std::size_t width) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    CAPTURE(line, width);
    CHECK(display_width(line) <= width);
  }
}

const auto constant = [](double checks) { return [checks](std::size_t, std::uint64_t) { return checks; }; };

/// A baseline, and a strategy with a guide that pays and one that costs.
Costs two() {
  Costs costs({"tree", "nested"}, 1, 12);
  costs.run("nested", [](std::size_t, std::uint64_t seed) { return 1000.0 + static_cast<double>(seed); });
  costs.run("tree", [](std::size_t, std::uint64_t seed) { return 9000.0 + static_cast<double>(seed); });
  costs.facts.given_baseline = "tree";
  costs.leave_out("nested", "skeleton()", [](const RunFacts& run) {
    return CensoredCost{8.0 * static_cast<double>(run.validity_checks), true};
  });
  costs.leave_out("nested", "shrink(0.5)", [](const RunFacts& run) {
    return CensoredCost{0.5 * static_cast<double>(run.validity_checks), true};
  });
  return costs;
}

const AnswerRow& row_of(const AnswerTable& table, const std::string& label) {
  const auto found =
      std::find_if(table.rows.begin(), table.rows.end(), [&](const AnswerRow& row) { return row.label == label; });
  REQUIRE(found != table.rows.end());
  return *found;
}

}  // namespace

TEST_CASE("numbers have two figures and no exponent", "[report][answer]") {
  CHECK(two_figures(0.11) == "0.11");
  CHECK(two_figures(0.06) == "0.060");
  CHECK(two_figures(0.0224) == "0.022");
  CHECK(two_figures(8.44) == "8.4");
  CHECK(two_figures(0.996) == "1.0");
  CHECK(two_figures(9.96) == "10");
  CHECK(two_figures(94.2) == "94");
  CHECK(two_figures(1234.0) == "1,200");
  CHECK(two_figures(0.0) == "0");
  CHECK(two_figures(infinity) == "∞");
  CHECK(thousands(999.0) == "999");
  CHECK(thousands(51823.0) == "51,823");
  CHECK(thousands(1234567.0) == "1,234,567");
  CHECK(thousands(-1234.0) == "-1,234");
  CHECK(thousands(-123.0) == "-123");
}

TEST_CASE("the table has a row for each strategy and below it for each guide left out", "[report][answer]") {
  const Costs costs = two();
  const Answer answer = costs.answer();
  REQUIRE(answer.table() != nullptr);
  const std::vector<AnswerRow>& rows = answer.table()->rows;
  REQUIRE(rows.size() == 4);
  CHECK(rows[0].label == "tree");
  CHECK(rows[0].verdict.word.empty());
  CHECK_FALSE(rows[0].ratio);
  CHECK(rows[1].label == "nested");
  CHECK(rows[1].verdict.word == "pays");
  CHECK(rows[1].ratio_text() == "0.11");
  CHECK(rows[2].label == "without skeleton()");
  CHECK(rows[2].verdict.word == "keep it");
  CHECK(rows[2].ratio_text() == "8.0");
  CHECK(rows[2].solved_text() == "12/12");
  CHECK(rows[3].verdict.word == "drop it");
  CHECK(rows[3].ratio_text() == "0.50");
  CHECK(rows[3].indent == 1);
  CHECK(answer.sentence ==
        "nested needs 9 times fewer validity checks than tree; skeleton() earns its place, shrink(0.5) costs more than "
        "it saves");
  const std::string text = costs.text();
  CHECK(text.starts_with("world 1, 12 seeds: validity checks until the first path, medians\n"));
  CHECK(has(text, "ratio: checks ÷ tree's; below a strategy ÷ the strategy's; same seeds, [95 % interval]\n"));
  CHECK(has(text, "leave out shrink(0.5) of nested: without it the strategy takes 0.50 times the validity checks"));
  CHECK_FALSE(has(text, "nats"));
}

TEST_CASE("the row without a guide has the inverse of its verdict", "[report][answer]") {
  std::mt19937 random(7);
  std::lognormal_distribution<double> factor(0.3, 0.8);
  for (int trial = 0; trial < 200; ++trial) {
    Costs costs({"tree", "nested"}, 1, 4 + static_cast<std::size_t>(trial) % 20);
    costs.run("tree", constant(5000.0));
    costs.run("nested", [&](std::size_t, std::uint64_t) { return random() % 7 == 0 ? infinity : 1000.0; });
    costs.leave_out("nested", "skeleton()", [&](const RunFacts&) {
      const double spent = std::floor(1000.0 * factor(random));
      const auto kind = random() % 5;
      return CensoredCost{spent, kind > 1, kind == 1};
    });
    const ExperimentSummary summary = costs.summary();
    const AnswerRow& row = row_of(*summary.answer.table(), "without skeleton()");
    const std::vector<GuideVerdict> verdicts = guide_verdicts(costs.facts, false);
    REQUIRE(verdicts.size() == 1);
    const Verdict& verdict = verdicts.front().verdict;
    REQUIRE(row.ratio);
    const auto inverts = [](const RatioBracket& a, const RatioBracket& b) {
      const auto one = [](double x, double y) {
        return x == 0.0 ? std::isinf(y) : x * y == Approx(1.0) || (std::isinf(x) && y == 0.0);
      };
      return one(a.lo, b.hi) && one(a.hi, b.lo);
    };
    CHECK(inverts(row.ratio->median, verdict.ratio.median));
    CHECK(inverts(row.ratio->interval, verdict.ratio.interval));
    CHECK(row.runs == verdict.counts.pairs);
    const bool small = row.verdict.word == "hardly matters";
    CHECK((row.verdict.word == "keep it") == (verdict.kind == Verdict::Kind::pays && !small));
    CHECK((row.verdict.word == "drop it") == (verdict.kind == Verdict::Kind::costs && !small));
    if (small) CHECK((row.ratio->median.lo > 1.0 / least_effect && row.ratio->median.hi < least_effect));
    // A run without the guide that was cut off counts at what it spent, and as none.
    CHECK(row.checks.lo <= row.checks.hi);
    CHECK(row.solved + row.cut_off <= row.runs);
  }
}

TEST_CASE("a difference of less than a tenth hardly matters, and never costs", "[report][answer]") {
  for (const auto& [factor, strategy, guide] :
       {std::tuple{1.02, "hardly matters", "hardly matters"}, std::tuple{0.98, "hardly matters", "hardly matters"},
        std::tuple{1.5, "costs", "drop it"}, std::tuple{0.5, "pays", "keep it"}}) {
    CAPTURE(factor);
    Costs costs({"tree", "nested"}, 1, 12);
    costs.run("tree", constant(10'000.0));
    costs.run("nested", constant(10'000.0 * factor));
    costs.facts.given_baseline = "tree";
    costs.leave_out("nested", "lazy()", [](const RunFacts&) { return CensoredCost{10'000.0, true}; });
    const Answer answer = costs.answer();
    CHECK(row_of(*answer.table(), "nested").verdict.word == strategy);
    CHECK(row_of(*answer.table(), "without lazy()").verdict.word == guide);
    CHECK((answer.next.find("leave out") == 0) == (factor > 1.1));
  }
}

TEST_CASE("a strategy alone has no ratio, and its guides have one", "[report][answer]") {
  Costs costs({"nested"}, 1, 12);
  costs.run("nested", constant(1000.0));
  std::string text = costs.text();
  CHECK(has(text, "12/12"));
  CHECK_FALSE(has(text, "ratio"));
  CHECK(costs.answer().sentence == "nested solves 12 of 12 runs, with 1,000 validity checks in the median");
  costs.leave_out("nested", "lazy()", [](const RunFacts&) { return CensoredCost{4000.0, true}; });
  text = costs.text();
  CHECK(has(text, "ratio: checks below a strategy ÷ the strategy's; same seeds"));
  CHECK(has(text, "keep it"));
  check_width(text, 100);
}

TEST_CASE("runs without a path are none, and infinitely worse", "[report][answer]") {
  Costs costs({"tree", "nested"}, 1, 12);
  SECTION("of all strategies") {
    costs.run("tree", constant(infinity));
    costs.run("nested", constant(infinity));
    costs.facts.given_baseline = "tree";
    const std::string text = costs.text();
    CHECK(has(text, "0/12"));
    CHECK(has(text, "none  ············"));
    CHECK(has(text, "tree: 12 unsolved: 50000 proposals spent at level 0\n"));
    CHECK(costs.answer().sentence == "no run found a path");
    CHECK(has(text, "tree solves 0 of 12 runs"));
    CHECK_FALSE(has(text, "inf"));
    CHECK_FALSE(has(text, "nan"));
  }
  SECTION("of the baseline") {
    costs.run("tree", constant(infinity));
    costs.run("nested", constant(1000.0));
    costs.facts.given_baseline = "tree";
    const AnswerRow& row = costs.answer().table()->rows[1];
    CHECK(row.ratio_text() == "0");
    CHECK(row.interval_text() == "[0, 0]");
    CHECK(row.verdict.word == "pays");
    CHECK(costs.answer().sentence == "nested solves 12 of 12 runs, tree solves 0");
  }
  SECTION("without a guide, and runs that were cut off") {
    costs.run("tree", constant(5000.0));
    costs.run("nested", constant(1000.0));
    costs.facts.given_baseline = "tree";
    costs.leave_out("nested", "skeleton()", [](const RunFacts&) { return CensoredCost{9000.0, false}; });
    costs.leave_out("nested", "lazy()", [](const RunFacts&) { return CensoredCost{2000.0, false, true}; });
    const Answer answer = costs.answer();
    const AnswerRow& never = row_of(*answer.table(), "without skeleton()");
    CHECK(never.checks_text() == "none");
    CHECK(never.ratio_text() == "∞");
    CHECK(never.verdict.word == "keep it");
    const AnswerRow& cut = row_of(*answer.table(), "without lazy()");
    CHECK(cut.solved_text() == "≥0/12");
    CHECK(cut.checks_text() == "≥2,000");
    CHECK(cut.ratio_text() == "≥2.0");
    CHECK(cut.interval_text() == "[2.0, ∞]");
    CHECK(has(costs.text(), "≥: runs without the guide were cut off"));
  }
}

TEST_CASE("verdicts without a direction say what would decide them", "[report][answer]") {
  Costs costs({"tree", "nested"}, 1, 6);
  costs.run("tree", constant(5000.0));
  costs.run("nested", constant(1000.0));
  costs.facts.given_baseline = "tree";
  costs.facts.ablation = 2.0;
  costs.leave_out("nested", "lazy()", [](const RunFacts& run) {
    return CensoredCost{run.seed % 2 == 0 ? 2000.0 : 400.0, true};
  });
  const std::string text = costs.text();
  CHECK(has(text, "nested: not shown; ~8 seeds would probably show it\n"));
  CHECK(has(text, "nested without lazy(): not shown; budget spent: --ablation 4\n"));
  CHECK(has(text, "verdicts: at most 5 % wrong verdicts"));
}

TEST_CASE("several problems make one matrix of ratios", "[report][answer]") {
  Costs costs({"thin", "nested", "tree"}, 6, 12);
  costs.run("thin", [](std::size_t p, std::uint64_t) { return p == 3 ? 10'000.0 : 4900.0; });
  costs.run("nested", [](std::size_t p, std::uint64_t) { return 100.0 * static_cast<double>(p); });
  costs.run("tree", constant(5000.0));
  costs.facts.given_baseline = "tree";
  costs.leave_out("nested", "skeleton()", [](const RunFacts& run) {
    return CensoredCost{static_cast<double>(run.validity_checks) * (run.problem == "world 1" ? 0.5 : 3.0), true};
  });
  const Answer answer = costs.answer();
  REQUIRE(answer.matrix);
  CHECK(answer.table() == nullptr);
  const AnswerMatrix& matrix = *answer.matrix;
  CHECK(matrix.reference == "tree");
  // The one that needs fewest comes first.
  REQUIRE(matrix.strategies.size() == 2);
  CHECK(matrix.strategies[0].label == "nested");
  CHECK(matrix.strategies[0].verdict.word == "pays 6 of 6");
  CHECK(matrix.strategies[0].cells[4].text() == "0.10");
  // 2 % are no reason.
  CHECK(matrix.strategies[1].verdict.word == "costs 1 of 6");
  REQUIRE(matrix.guides.size() == 1);
  CHECK(matrix.guides[0].verdict.word == "keep 5, drop 1 of 6");
  CHECK(answer.sentence ==
        "nested needs fewer validity checks than tree in 6 of 6 problems; skeleton() earns its place");
  const std::string text = costs.text();
  CHECK(has(text, "nested without skeleton()"));
  CHECK(has(text, "keep 5, drop 1 of 6"));
  check_width(text, 100);
  check_width(costs.text(80), 80);
}

TEST_CASE("hundreds of problems are one table, by group, with the range over the runs", "[report][answer]") {
  Costs costs({"tree", "nested"}, 200, 2);
  for (std::size_t p = 0; p < 200; ++p) costs.facts.problems[p].group = p < 120 ? "gap" : "shelf";
  costs.run("tree", constant(1000.0));
  costs.run("nested", [](std::size_t p, std::uint64_t) { return p <= 120 ? 400.0 : 2000.0; });
  costs.facts.given_baseline = "tree";
  const Answer answer = costs.answer();
  REQUIRE(answer.groups);
  CHECK(answer.groups->groups == std::vector<std::pair<std::string, std::size_t>>{{"gap", 120}, {"shelf", 80}});
  REQUIRE(answer.groups->lines.size() == 1);
  const AnswerGroups::Line& line = answer.groups->lines.front();
  CHECK(line.ratios == std::vector<double>{0.4, 2.0});
  CHECK(line.cheaper == 240);
  CHECK(line.runs == 400);
  CHECK(line.lo == 0.4);
  CHECK(line.hi == 2.0);
  const std::string text = costs.text();
  CHECK(text.starts_with("200 problems, 2 seeds each: validity checks until the first path, medians of 400 runs\n"));
  CHECK(has(text, "gap (120)"));
  CHECK(has(text, "240 of 400   0.40 … 2.0\n"));
  check_width(text, 100);
  // Without groups the range remains.
  for (ProblemFacts& problem : costs.facts.problems) problem.group.clear();
  CHECK(has(costs.text(), "240 of 400   0.40 … 2.0\n"));
  CHECK_FALSE(has(costs.text(), "by group"));
}

TEST_CASE("tables are aligned and fit, also with wide names", "[report][answer]") {
  CHECK(display_width("道を探す") == 8);
  CHECK(display_width("e\xCC\x81") == 1);
  CHECK(display_width("🤖") == 2);
  const std::string wide = "道を探す";
  Costs costs({"tree", wide}, 1, 12);
  costs.run("tree", constant(9000.0));
  costs.run(wide, constant(1000.0));
  costs.facts.given_baseline = "tree";
  costs.leave_out(wide, "骨格を辿る()", [](const RunFacts&) { return CensoredCost{8000.0, true}; });
  const auto column = [](const std::string& text, const std::string& line_with, const std::string& what) {
    const std::size_t at = text.find(line_with);
    REQUIRE(at != std::string::npos);
    const std::string line = text.substr(at, text.find('\n', at) - at);
    return display_width(line.substr(0, line.find(what)));
  };
  const std::string text = costs.text();
  CHECK(column(text, wide + " ", "12/12") == column(text, "tree ", "12/12"));
  CHECK(column(text, "  without 骨", "12/12") == column(text, "tree ", "12/12"));
  CHECK(column(text, wide + " ", "pays") == column(text, "  without 骨", "keep it"));
  check_width(text, 100);

  // Long names are shortened, and narrow reports are split.
  const std::string name(90, 'x');
  Costs longer({"tree", name}, 1, 12);
  longer.run("tree", constant(9000.0));
  longer.run(name, constant(1000.0));
  longer.facts.given_baseline = "tree";
  for (const int columns : {60, 80, 100}) {
    std::istringstream lines(longer.text(columns));
    for (std::string line; std::getline(lines, line);) {
      // Sentences have the whole name.
      if (!has(line, name)) CHECK(display_width(line) <= static_cast<std::size_t>(columns));
    }
  }
  for (const int columns : {60, 80, 100}) check_width(two().text(columns), static_cast<std::size_t>(columns));
}
