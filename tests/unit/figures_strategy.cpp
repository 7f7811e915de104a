// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of the measure as files, and strategies compared run by run.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/draw/figures.hpp>
#include <trellis/figures/charts/figures.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/words.hpp>

#include "report_fixture.hpp"
#include "report_folder.hpp"
#include "support/catch.hpp"

using namespace trellis;
using fixture::check_pictures;
using fixture::Files;
using fixture::Folder;
using fixture::read;
namespace fs = std::filesystem;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Where along the path the samples of every level lie, made up.
void add_profiles(ExperimentResult& result) {
  for (RunResult& run : result.runs) {
    for (LevelResult& level : run.levels) {
      if (!level.own) continue;
      for (Efficiency* e : {&level.own->tree, &level.own->expansion, level.root ? &level.root->tree : nullptr,
                            level.root ? &level.root->expansion : nullptr}) {
        if (e == nullptr || std::isnan(e->value)) continue;
        e->along.length = 12.0;
        e->along.target = {0.3, 0.3, 0.4};
        e->along.samples = {0.5, 0.5, 0.0};
        e->parts.mass = 0.8 * std::max(e->value, 0.0);
        e->parts.spread = 0.2 * std::max(e->value, 0.0);
        e->along.divergence = 0.5;
        e->along.empty_share = 0.4;
      }
    }
  }
}

/// One cell with a root of the given efficiencies; NaN: not scored.
RunResult cell(const std::string& strategy, std::uint64_t seed, double tree, double expansion, std::uint64_t checks,
               bool solved = true) {
  RunResult run = fixture::plain_run("p", seed, solved);
  run.strategy = strategy;
  run.run.validity_checks = checks;
  LevelResult& root = run.levels.front();
  root.root.reset();
  root.own.reset();
  if (!std::isnan(tree)) {
    root.root_cross = Scores{fixture::efficiency(2.5, tree, 100), fixture::efficiency(2.5, expansion, 200)};
  }
  return run;
}

}  // namespace

TEST_CASE("every strategy that was scored has its pictures in a folder of its own", "[report][figures]") {
  auto [experiment, result] = fixture::passage();
  add_profiles(result);
  const Folder folder;
  write_figures(summarise(facts_of(experiment, result)), folder.path().string());
  Files expected;
  for (const char* strategy : {"rrt", "nested"}) {
    for (const std::string picture : {"waterfall", "profile", "strip", "plane"}) {
      // A strategy without guides has one level, and no plane.
      if (picture == "plane" && strategy == std::string("rrt")) continue;
      for (const char* format : {"svg", "png", "pdf"}) {
        expected.insert(std::string("simple_passage/") + strategy + "/" + picture + "." + format);
      }
    }
  }
  CHECK(folder.files() == expected);
  check_pictures(folder);

  // The same bytes the second time, over the first.
  const std::string before = read(folder.path() / "simple_passage/nested/waterfall.svg");
  write_figures(summarise(facts_of(experiment, result)), folder.path().string());
  CHECK(folder.files() == expected);
  CHECK(read(folder.path() / "simple_passage/nested/waterfall.svg") == before);
}

TEST_CASE("a waterfall goes from uniform sampling to the root under the strategy's name", "[report][figures]") {
  const auto [experiment, result] = fixture::passage();
  const Folder folder;
  write_figures(summarise(facts_of(experiment, result)), folder.path().string());
  // Text is drawn as outlines, so the picture is compared as a whole with one made from plain numbers.
  std::vector<double> tree;
  std::vector<double> expansion;
  for (const RunResult& run : result.runs) {
    if (run.strategy != "rrt" || !run.levels.front().root) continue;
    tree.push_back(run.levels.front().root->tree.value);
    expansion.push_back(run.levels.front().root->expansion.value);
  }
  REQUIRE(tree.size() == 14);
  draw::Waterfall picture;
  picture.title = "rrt on simple_passage: what each level adds above uniform";
  picture.caption =
      "Lifted to the root's space: means over 14 runs, on their own paths; whiskers: what the samples support, with 95 "
      "%.";
  const auto panel = [](const std::string& role, const std::vector<double>& values) {
    // The fixture's intervals end 0.2 below and 0.3 above each estimate of the divergence.
    const Interval all = student_interval(values);
    const double lo = 2.41 - (all.hi + 0.3);
    const double hi = 2.41 - (all.lo - 0.2);
    draw::WaterfallPanel p;
    p.title = role;
    p.levels = {{"root", 0.5 * (lo + hi), lo, hi}};
    p.root = {"above uniform", 0.5 * (lo + hi), lo, hi};
    return p;
  };
  picture.panels = {panel("tree", tree), panel("expansion", expansion)};
  const std::string expected = draw::plot(draw::waterfall(picture)).render(draw::Format::svg);
  const bool same = read(folder.path() / "simple_passage/rrt/waterfall.svg") == expected;
  CHECK(same);
  picture.title = "nested on simple_passage: what each level adds above uniform";
  const bool other = draw::plot(draw::waterfall(picture)).render(draw::Format::svg) == expected;
  CHECK_FALSE(other);
}

TEST_CASE("nothing is drawn of what was not scored", "[report][figures]") {
  auto [experiment, result] = fixture::passage();
  SECTION("a strategy without a path") {
    for (RunResult& run : result.runs) {
      if (run.strategy != "rrt") continue;
      for (LevelResult& level : run.levels) level.own = level.root = std::nullopt;
    }
    const Folder folder;
    write_figures(summarise(facts_of(experiment, result)), folder.path().string());
    CHECK(folder.files() == Files{"simple_passage/nested/waterfall.svg", "simple_passage/nested/waterfall.png",
                                  "simple_passage/nested/waterfall.pdf"});
    CHECK_FALSE(fs::exists(folder.path() / "simple_passage" / "rrt"));
    check_pictures(folder);
  }
  SECTION("no measure") {
    experiment.measure.reset();
    for (RunResult& run : result.runs) {
      for (LevelResult& level : run.levels) level.own = level.root = std::nullopt;
    }
    const Folder folder;
    write_figures(summarise(facts_of(experiment, result)), (folder.path() / "new").string());
    CHECK(folder.files().empty());
    CHECK_FALSE(fs::exists(folder.path() / "new"));
  }
  SECTION("figures that are infinite or missing leave a picture that can be read") {
    add_profiles(result);
    result.runs[0].levels[0].root->tree.value = infinity;
    result.runs[0].levels[0].root->tree.above_uniform = -infinity;
    result.runs[1].levels[0].root->tree = fixture::no_figure(not_a_number);
    const Folder folder;
    write_figures(summarise(facts_of(experiment, result)), folder.path().string());
    CHECK(folder.files().size() == 21);
    check_pictures(folder);
  }
}

TEST_CASE("the plane has a point for each level and an arrow to each from what guides it", "[report][figures]") {
  auto [experiment, result] = fixture::passage();
  add_profiles(result);
  // Few samples of the lower levels support nothing: they have no point.
  const auto few =
      strategy_figures("simple_passage", "nested", summarise(facts_of(experiment, result), "simple_passage", "nested"))
          .plane;
  REQUIRE(few);
  CHECK(few->panels[0].series.size() == 3);
  CHECK(few->caption.find("not drawn: too few samples") != std::string::npos);
  for (RunResult& run : result.runs) {
    for (LevelResult& level : run.levels) {
      if (!level.root) continue;
      for (Efficiency* e : {&level.root->tree, &level.root->expansion}) {
        e->value_lo = e->value - 0.2;
        e->value_hi = e->value + 0.3;
      }
    }
  }
  const RunsSummary summary = summarise(facts_of(experiment, result), "simple_passage", "nested");
  const auto figure = strategy_figures("simple_passage", "nested", summary).plane;
  REQUIRE(figure);
  REQUIRE(figure->panels.size() == 2);
  const draw::Panel& tree = figure->panels[0];
  std::vector<std::string> names;
  for (const draw::Series& series : tree.series) names.push_back(series.name);
  CHECK(names == std::vector<std::string>{"uniform sampling", "0 root", "1 lazy()", "2 shrink(0.5)", "3 skeleton()"});
  for (std::size_t i = 0; i < 4; ++i) {
    const draw::Series& point = tree.series[i + 1];
    const Figure& lifted = summary.levels[i].root.tree;
    const double mass = lifted["D_uniform"].value - lifted["SE_parts.mass"].value;
    const AboveUniform above = headline(summary.levels[i], SampleRole::tree).above;
    CHECK(point.x.front() == Approx(mass));
    CHECK(point.y.front() == Approx(0.5 * (above.lo + above.hi) - mass));
    CHECK(point.x_lo.front() <= point.x.front());
    CHECK(point.lo.front() <= point.y.front());
    CHECK(*point.colour == draw::palette::level(i));
  }
  REQUIRE(tree.connectors.size() == 4);
  const auto leads = [&](std::size_t arrow, std::size_t from, std::size_t to) {
    const draw::Connector& c = tree.connectors[arrow];
    return c.arrow && c.from == draw::Point{tree.series[from].x[0], tree.series[from].y[0]} &&
           c.to == draw::Point{tree.series[to].x[0], tree.series[to].y[0]};
  };
  CHECK(leads(0, 0, 4));
  CHECK(leads(1, 4, 3));
  CHECK(leads(2, 3, 2));
  CHECK(leads(3, 2, 1));
  CHECK(figure->caption.find("means over 15 runs, on their own paths") != std::string::npos);
  // The skeleton proposes nothing: three levels and uniform sampling.
  CHECK(figure->panels[1].series.size() == 4);
}

TEST_CASE("strips have the shares of the profile, a strip for each level and role", "[report][figures]") {
  auto [experiment, result] = fixture::passage();
  add_profiles(result);
  const RunsSummary summary = fixture::summary_of(result, "simple_passage", "nested");
  const auto figure = strategy_figures("simple_passage", "nested", summary).strip;
  REQUIRE(figure);
  REQUIRE(figure->strips.size() == 7);
  CHECK(figure->strips[0].name == "root: tree");
  CHECK(figure->strips[6].name == "skeleton(): tree");
  for (const draw::Strip& strip : figure->strips) {
    REQUIRE(strip.share.size() == 3);
    CHECK(strip.share[0] == Approx(0.5));
    CHECK(strip.share[2] == 0.0);
    CHECK(strip.target[2] == Approx(0.4));
  }
  CHECK(figure->caption.find("Means over") != std::string::npos);
}

TEST_CASE("waterfalls side by side have one scale, which ends beyond perfect guidance", "[report][figures]") {
  auto [experiment, result] = fixture::passage();
  const RunsSummary nested = fixture::summary_of(result, "simple_passage", "nested");
  const RunsSummary plain = fixture::summary_of(result, "simple_passage", "rrt");
  // One strategy with guides has nothing to stand beside.
  CHECK_FALSE(waterfalls_figure("simple_passage", {{"rrt", &plain}, {"nested", &nested}}));
  RunsSummary other = nested;
  other.levels[0].root.tree["D_perfect"].value = 0.05;
  const auto figure = waterfalls_figure("simple_passage", {{"a", &nested}, {"rrt", &plain}, {"b", &other}});
  REQUIRE(figure);
  REQUIRE(figure->panels.size() == 4);
  CHECK(figure->panels[0].title == "a\ntree");
  CHECK(figure->panels[3].title == "b\nexpansion");
  CHECK(figure->share_y);
  for (const draw::Panel& panel : figure->panels) {
    REQUIRE(panel.y.lo);
    REQUIRE(panel.y.hi);
    CHECK(*panel.y.lo == *figure->panels[0].y.lo);
    CHECK(*panel.y.hi == *figure->panels[0].y.hi);
    CHECK(*panel.y.hi > 2.41 - 0.05);
  }
}

TEST_CASE("names of levels are shortened but stay distinct", "[report][figures]") {
  CHECK(short_level("lazy()", 14) == "lazy()");
  CHECK(short_level("shrink { 0.6666666666, keep_tree = true }", 14) == "shrink(0.667)");
  CHECK(short_level("skeleton { follow = \"regions\" }", 14) == "skeleton");
  CHECK(short_level("a_function_of_a_script", 14) == "a_function_of_a_script");
  CHECK(short_level("robots 1, 2, 5", 14) == "robots 1, 2, 5");
  CHECK(short_level("robots 1, 2, 5", 12) == "3 robots");
}

TEST_CASE("a mixture has a waterfall for each path to the root", "[report][figures]") {
  auto [experiment, result] = fixture::passage();
  // The skeleton guides the root beside lazy >> shrink.
  for (RunResult& run : result.runs) {
    for (LevelResult& level : run.levels) {
      if (level.record.key == "0/0/0/0") level.record.key = "0/0.1";
    }
  }
  const Folder mixture;
  write_figures(summarise(facts_of(experiment, result)), mixture.path().string());
  check_pictures(mixture);
  const auto [chain_experiment, chain_result] = fixture::passage();
  const Folder chain;
  write_figures(summarise(facts_of(chain_experiment, chain_result)), chain.path().string());
  const std::string file = "simple_passage/nested/waterfall.svg";
  CHECK(read(mixture.path() / file).size() > read(chain.path() / file).size());
}

TEST_CASE("names that are no file names get folders of their own for their pictures", "[report][figures]") {
  Experiment experiment;
  ExperimentResult result;
  experiment.strategies = {{"r<r>&t", fixture::plain()}, {"r?r??t", fixture::plain()}};
  experiment.seeds = {1};
  for (const char* name : {"a/b", "..", "a & <b>"}) {
    experiment.problems.push_back(fixture::problem(name));
    for (const auto& [strategy, spec] : experiment.strategies) {
      result.runs.push_back(fixture::plain_run(name, 1, true));
      result.runs.back().strategy = strategy;
    }
  }
  const Folder folder;
  write_figures(summarise(facts_of(experiment, result)), folder.path().string());
  Files expected;
  for (const char* problem : {"a-b", "-.", "a----b-"}) {
    for (const char* strategy : {"r-r--t", "r-r--t-2"}) {
      for (const char* format : {"svg", "png", "pdf"}) {
        expected.insert(std::string(problem) + "/" + strategy + "/waterfall." + format);
      }
    }
  }
  CHECK(folder.files() == expected);
  check_pictures(folder);
}

TEST_CASE("pictures that cannot be written are an error that says where and why", "[report][figures]") {
  const auto [experiment, result] = fixture::passage();
  const Folder folder;
  const fs::path taken = folder.path() / "taken";
  std::ofstream(taken) << "mine";
  SECTION("a file where the folder should be") {
    CHECK_THROWS_WITH(
        write_figures(summarise(facts_of(experiment, result)), taken.string()),
        "cannot make the directory '" + (taken / "simple_passage" / "rrt").string() + "': Not a directory");
    CHECK(read(taken) == "mine");
  }
  SECTION("a folder where a picture should be") {
    const fs::path picture = folder.path() / "simple_passage" / "rrt" / "waterfall.svg";
    fs::create_directories(picture);
    CHECK_THROWS_WITH(write_figures(summarise(facts_of(experiment, result)), folder.path().string()),
                      "cannot write '" + picture.string() + "': Is a directory");
  }
  SECTION("a folder without permission to create it") {
    if (fs::exists("/proc"))
      CHECK_THROWS_AS(write_figures(summarise(facts_of(experiment, result)), "/proc/trellis-figures"), Error);
  }
}

TEST_CASE("strategies are compared with the baseline seed by seed", "[report][compare]") {
  Experiment experiment;
  experiment.problems = {fixture::problem("p")};
  experiment.strategies = {{"base", fixture::plain()}, {"better", fixture::plain()}, {"without", fixture::plain()}};
  experiment.seeds = {1, 2, 3, 4, 5};
  experiment.ablations = {{"without", "better", "without lazy()"}};
  // Efficiencies differ much between the seeds and little between the strategies.
  const std::vector<double> base = {1.0, 3.0, 2.0, 5.0, 4.0};
  const std::vector<double> won = {0.3, 0.2, 0.4, 0.3, 0.3};
  ExperimentResult result;
  for (std::size_t i = 0; i < 5; ++i) result.runs.push_back(cell("base", i + 1, base[i], 2.0, 1000 * (i + 1)));
  for (std::size_t i = 0; i < 5; ++i) {
    result.runs.push_back(cell("better", i + 1, base[i] - won[i], 2.0, 250 * (i + 1), i != 2));
  }
  for (std::size_t i = 0; i < 5; ++i) result.runs.push_back(cell("without", i + 1, base[i], 2.5, 500 * (i + 1)));

  const auto compared = compare(facts_of(experiment, result), false);
  REQUIRE(compared.size() == 2);
  const Comparison& better = compared[0];
  CHECK(better.problem == "p");
  CHECK(better.strategy == "better");
  CHECK(better.baseline == "base");
  CHECK(better.text.empty());
  CHECK(better.cross);
  CHECK(better.tree.difference.value == Approx(-0.3));
  CHECK(better.tree.difference.n == 5);
  // Student's interval of the five differences, far narrower than what the strategies spread over.
  CHECK(better.tree.difference.hi - better.tree.difference.value == Approx(2.776445 * std::sqrt(0.005 / 5)));
  CHECK(better.tree.less == 5);
  CHECK(better.tree.greater == 0);
  CHECK(better.tree.sign_p == Approx(2.0 / 32));
  CHECK(better.expansion.difference.value == 0.0);
  CHECK(better.expansion.equal == 5);
  CHECK(better.expansion.sign_p == 1.0);
  // The third seed found no path: 0.25 on the other four, infinite there.
  CHECK(better.validity_checks.ratio.value == 0.25);
  CHECK(better.validity_checks.less == 4);
  CHECK(better.validity_checks.greater == 1);
  CHECK(better.validity_checks.solved == 4);
  CHECK(better.validity_checks.reference_solved == 5);
  CHECK(better.validity_checks.both_solved == 4);
  CHECK(better.validity_checks.difference.value == -1500.0);
  CHECK(better.solved.difference.value == Approx(-0.2));
  CHECK(better.solved.difference.lo >= -1.0);
  CHECK(better.solved.less == 1);
  // An ablation is listed beside the complete strategy.
  const Comparison& without = compared[1];
  CHECK(without.baseline == "better");
  CHECK(without.text == "without lazy()");
  CHECK(without.tree.difference.value == Approx(0.3));
  CHECK(without.expansion.greater == 5);
  CHECK(without.validity_checks.ratio.value == 2.0);
  // Two comparisons are shown: the smaller p is doubled.
  CHECK(without.expansion.sign_p == Approx(2.0 / 32));
  CHECK(without.expansion.holm_p == Approx(4.0 / 32));

  SECTION("another baseline") {
    experiment.baseline = "better";
    experiment.ablations.clear();
    const auto turned = compare(facts_of(experiment, result), false);
    REQUIRE(turned.size() == 2);
    CHECK(turned[0].strategy == "base");
    CHECK(turned[0].tree.difference.value == Approx(0.3));
    CHECK(turned[0].tree.difference.lo == Approx(-better.tree.difference.hi));
    CHECK(turned[0].validity_checks.ratio.value == 4.0);
  }
  SECTION("a run that was not scored leaves its pair out, and keeps its success and its checks") {
    result.runs[6].levels.front().root_cross.reset();
    const Comparison some = compare(facts_of(experiment, result), false).front();
    CHECK(some.tree.difference.n == 4);
    CHECK(some.tree.difference.value == Approx(-1.3 / 4));
    CHECK(std::isnan(some.tree.difference.lo));  // four values have no interval
    CHECK(some.solved.difference.n == 5);
    CHECK(some.validity_checks.pairs == 5);
  }
  SECTION("infinite figures are not averaged") {
    result.runs[5].levels.front().root_cross->tree.value = infinity;
    const Comparison some = compare(facts_of(experiment, result), false).front();
    CHECK(some.tree.difference.infinite == 1);
    CHECK(some.tree.difference.value == Approx(-0.3));  // the median
    CHECK(std::isnan(some.tree.difference.lo));
    CHECK(some.tree.greater == 1);
  }
  SECTION("without other seeds' paths their own serve") {
    for (RunResult& run : result.runs) std::swap(run.levels.front().root, run.levels.front().root_cross);
    const Comparison own = compare(facts_of(experiment, result), false).front();
    CHECK_FALSE(own.cross);
    CHECK(own.tree.difference.value == Approx(-0.3));
  }
  SECTION("one strategy has nothing to be compared with") {
    experiment.strategies.erase(experiment.strategies.begin() + 1, experiment.strategies.end());
    experiment.ablations.clear();
    CHECK(compare(facts_of(experiment, result), false).empty());
  }
}

TEST_CASE("a run without a path lowers the success and stays in the cross figures", "[report][compare]") {
  ExperimentResult result;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    result.runs.push_back(cell("s", seed, static_cast<double>(seed), 2.0, 100, seed != 4));
  }
  const RunsSummary summary = fixture::summary_of(result, "p", "s");
  CHECK(summary.runs == 4);
  CHECK(summary.solved == 3);
  CHECK(summary.success.value == 0.75);
  const Figure& cross = summary.levels.front().root_cross.tree;
  CHECK(cross.scored == 4);
  CHECK(cross["SE"].value == 2.5);
  CHECK(cross["SE"].n == 4);
  CHECK(summary.levels.front().root.tree.scored == 0);
  // One that is infinite is counted, and the median takes the mean's place.
  result.runs[1].levels.front().root_cross->tree.unregularised = infinity;
  const Figure counted = fixture::summary_of(result, "p", "s").levels.front().root_cross.tree;
  CHECK(counted["D"].infinite == 1);
  CHECK(counted["D"].value == Approx(0.5 * (3.01 + 4.01)));
}
