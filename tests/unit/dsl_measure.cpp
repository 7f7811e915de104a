// SPDX-License-Identifier: GPL-3.0-or-later
// Targets, estimators, and the measure of an experiment.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/script.hpp"

#include <dsl/language/tools/vocabulary.hpp>
#include <dsl/language/words/measure.hpp>
#include <trellis/base/random.hpp>

using namespace trellis;
using test::failure;
using test::value;
using test::values;

namespace {

dsl::Program load(const std::string& text) { return dsl::Session("").load(text, "test.lua"); }

/// An experiment of one RRT for a point in an empty world, with more fields.
std::string experiment(const std::string& fields) {
  return "return experiment { problems = problem { name = 'room', world = world { bounds = {0, 0, 10, 10} }, "
         "robot = robot.point(), start = {2, 5}, goal = {8, 5} }, strategies = { rrt = rrt { step = 0.5 } }, " +
         fields + " }";
}

const Measure& measure_of(const dsl::Program& program) {
  REQUIRE(program.experiment.measure);
  return *program.experiment.measure;
}

/// Returns the message of an experiment with these functions of a target, "" if it runs.
std::string run_failure(const std::string& functions) {
  const auto program = load(experiment("cross = 0,\nmeasure = target { " + functions + ", points = 64, pool = 64 }"));
  return test::fault_of([&] { run(program.experiment); });
}

/// T uniform within 0.5 of the path, as in a user's script: by rejection sampling. Its volume is that of a capsule.
constexpr const char* own_tube = R"(
local function distance(q, path)
  local best = math.huge
  for i = 1, #path - 1 do
    local a, b = path[i], path[i + 1]
    local dx, dy = b[1] - a[1], b[2] - a[2]
    local t = ((q[1] - a[1]) * dx + (q[2] - a[2]) * dy) / (dx * dx + dy * dy)
    t = math.max(0, math.min(1, t))
    best = math.min(best, (q[1] - a[1] - t * dx) ^ 2 + (q[2] - a[2] - t * dy) ^ 2)
  end
  return math.sqrt(best)
end
local own = target {
  sample = function(context)
    while true do
      local q = { 1 + 8 * context.random(), 4 + 2 * context.random() }
      if distance(q, context.path) < 0.5 then return q end
    end
  end,
  log_density = function(q, context)
    return distance(q, context.path) < 0.5 and -math.log(6 + math.pi / 4) or -math.huge
  end,
}
)";

}  // namespace

TEST_CASE("every target and estimator is a constructor, and its text is what a script would write") {
  for (const auto& components : {dsl::target_components(), dsl::estimator_components()}) {
    for (const Component* component : components) {
      INFO(component->name);
      CHECK(value("tostring(" + component->name + "())") == component->name + " {}");
      CHECK(value("tostring(" + component->name + "):match('^[%w_]+')") == component->name);
      CHECK(dsl::help_text(component->name).starts_with(component->name + " ("));
    }
  }
  CHECK(value("tostring(tube(0.25))") == "tube { delta = 0.25 }");
  CHECK(value("tostring(tube { distance = 'full', points = 128 })") == "tube { points = 128, distance = \"full\" }");
  CHECK(value("tostring(near_optimal(0.2))") == "near_optimal { epsilon = 0.2 }");
  CHECK(value("tostring(near_optimal { nodes = 500, delta = 0.3 })") == "near_optimal { nodes = 500, delta = 0.3 }");
  CHECK(value("tostring(progress { step = 0.25, delta = 0.05 })") == "progress { step = 0.25 }");
  CHECK(value("tostring(knn(5))") == "knn { k = 5 }");
  CHECK(value("tostring(arc { dimension = 3 })") == "arc { dimension = 3 }");
  CHECK(value("knn { k = 5 } == knn(5)") == "true");
  CHECK(value("knn {} == arc {}") == "false");
}

TEST_CASE("targets and estimators refuse what they cannot take") {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"tube { detla = 1 }", "tube: unknown option 'detla' (did you mean 'delta'?)"},
      {"tube { delta = 0 }", "tube: option 'delta' must be a number greater than 0 (m), got 0"},
      {"tube { epsilon = 0.05 }", "tube: unknown option 'epsilon'"},
      {"tube(1, 2)", "tube: takes one option without a name (delta), got 2"},
      {"near_optimal { epsilon = -1 }",
       "near_optimal: option 'epsilon' must be a number greater than 0 (share of the optimum), got -1"},
      {"near_optimal { nodes = 3 }", "near_optimal: option 'nodes' must be an integer"},
      {"progress { step = 0 }", "progress: option 'step' must be a number greater than 0"},
      {"knn { k = 0 }", "knn: option 'k' must be an integer"},
      {"knn { kk = 3 }", "knn: unknown option 'kk'; its options are: k, k_all, blend, boundary"},
      {"exact { k = 3 }", "exact: unknown option 'k'; it has no options"},
      {"target {}", "target: field 'sample' is missing: a function"},
      {"target { sample = print }", "target: field 'log_density' is missing: a function"},
      {"target { sample = 3, log_density = print }", "target: field 'sample' must be a function, got 3"},
      {"target { sample = print, log_density = print, dleta = 1 }", "unknown field 'dleta' (did you mean 'delta'?)"},
      {"target { sample = print, log_density = print, pool = 10 }", "target: option 'pool' must be an integer"},
  };
  for (const auto& [script, message] : wrong) {
    INFO(script);
    const std::string got = failure("local x = " + script);
    INFO(got);
    CHECK(got.starts_with("test.lua:1: "));
    CHECK(got.find(message) != std::string::npos);
  }
}

TEST_CASE("an experiment says what is measured, by what and beside what") {
  const auto plain = load(experiment(""));
  CHECK(std::get<TubeSettings>(measure_of(plain).target).delta == 0.5);
  CHECK(measure_of(plain).estimators == default_estimators());
  CHECK(measure_of(plain).cross == 2);
  CHECK_FALSE(measure_of(plain).cross_levels);
  CHECK_FALSE(measure_of(plain).metrics);

  const auto all =
      load(experiment("measure = near_optimal { epsilon = 0.25, delta = 0.3 }, estimators = { knn { k = 5 }, arc() }, "
                      "cross = 3, cross_levels = true, "
                      "metrics = true, baseline = 'rrt'"));
  CHECK(std::get<NearOptimalSettings>(measure_of(all).target).epsilon == 0.25);
  CHECK(std::get<NearOptimalSettings>(measure_of(all).target).delta == 0.3);
  REQUIRE(measure_of(all).estimators.size() == 2);
  CHECK(measure_of(all).estimators[0] == EstimatorSpec::make("knn", {{"k", std::int64_t{5}}}));
  CHECK(measure_of(all).estimators[1].name() == "arc");
  CHECK(measure_of(all).cross == 3);
  CHECK(measure_of(all).cross_levels);
  CHECK(measure_of(all).metrics);
  CHECK(all.experiment.baseline == "rrt");

  CHECK(std::get<ProgressSettings>(measure_of(load(experiment("measure = progress(0.25)"))).target).step == 0.25);
  CHECK(measure_of(load(experiment("estimators = arc {}"))).estimators == std::vector{EstimatorSpec::make("arc")});
  CHECK(measure_of(load(experiment("cross = 0"))).cross == 0);
  CHECK_FALSE(load(experiment("measure = false")).experiment.measure);
}

TEST_CASE("an experiment refuses what makes no measure") {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"measure = true", "field 'measure' must be a target, as tube { delta = 0.5 }, or false, got true"},
      {"measure = knn {}", "must be a target, as tube { delta = 0.5 }, or false, got the estimator 'knn'"},
      {"measure = tube", "got the constructor 'tube' (call it: tube())"},
      {"measure = false, cross = 2", "field 'cross' says how samples are measured, and 'measure = false'"},
      {"measure = false, metrics = true", "field 'metrics' says how samples are measured"},
      {"estimators = 'knn'", "field 'estimators' must be an estimator or a list of estimators"},
      {"estimators = {}", "field 'estimators' must be a list of estimators, got an empty one"},
      {"estimators = { k = 3 }", "field 'estimators' must be a list of estimators, got one with the field 'k'"},
      {"estimators = { knn {}, tube {} }",
       "element 2 of field 'estimators' must be an estimator, as knn {}, got the "
       "target 'tube {}'"},
      {"estimators = { knn }", "got the constructor 'knn' (call it: knn())"},
      {"estimators = { knn {}, arc {}, knn { k = 3 } }", "field 'estimators' holds knn twice"},
      {"cross = -1", "option 'cross' must be an integer at least 0 (paths), got -1"},
      {"cross = 1.5", "option 'cross' must be an integer"},
      {"metrics = 1", "option 'metrics' must be true or false, got 1"},
      {"baseline = 'rtr'", "baseline 'rtr' is no strategy (did you mean 'rrt'?)"},
      {"baseline = ''", "field 'baseline' must be the name of a strategy, got \"\""},
      {"baseline = 3", "field 'baseline' must be the name of a strategy, got 3"},
      {"ablate = true", "field 'ablate': no strategy has a guide that could be taken out"},
      {"ablate = { 'rtr' }", "'rtr' (did you mean 'rrt'?)"},
      {"ablate = { 'rrt' }", "strategy 'rrt' has no guide that could be taken out"},
      {"ablate = { 3 }", "field 'ablate' must hold names of strategies, got 3 as number 1"},
      {"ablate = { 'rrt', 'rrt' }", "field 'ablate' names the strategy 'rrt' twice"},
      {"ablate = 'rrt'", "field 'ablate' must be true, or a list of names of strategies, got \"rrt\""},
  };
  for (const auto& [fields, message] : wrong) {
    INFO(fields);
    const std::string got = failure(experiment(fields));
    INFO(got);
    CHECK(got.starts_with("test.lua:1: experiment: "));
    CHECK(got.find(message) != std::string::npos);
  }
}

TEST_CASE("guides are taken out of strategies") {
  const std::string head = "return experiment { problems = scenes.cup(), strategies = ";
  const auto taken = load(head + "{ nested = skeleton() >> shrink(0.5) >> rrt {} }, ablate = true }").experiment;
  std::vector<std::string> texts;
  for (const auto& [name, strategy] : taken.strategies) texts.push_back(strategy.text());
  CHECK(texts == std::vector<std::string>{"skeleton() >> shrink(0.5) >> rrt()", "rrt()", "skeleton() >> rrt()",
                                          "shrink(0.5) >> rrt()"});

  const std::string two = "{ guided = lazy() >> rrt {}, rrt = rrt {} }";
  const auto named = load(head + two + ", ablate = { 'guided' } }");
  const auto all = load(head + two + ", ablate = true }");
  for (const auto& program : {named, all}) {
    REQUIRE(program.experiment.strategies.size() == 3);
    REQUIRE(program.experiment.ablations.size() == 1);
    CHECK(program.experiment.ablations.front().of == "guided");
    CHECK(program.experiment.ablations.front().strategy == program.experiment.strategies.back().first);
  }
  auto again = all.experiment;
  dsl::ablate_all(again, "--ablate");
  CHECK(again.strategies.size() == 3);
  CHECK(load(head + two + ", ablate = false }").experiment.strategies.size() == 2);
}

TEST_CASE("a user's target that is the tube's gives the tube's figures") {
  const auto program = load(own_tube + experiment("measure = own"));
  // So many points that two draws of them agree in the first decimal.
  constexpr std::int64_t points = 4096;
  constexpr std::int64_t pool = 16384;
  UserTarget own = std::get<UserTarget>(measure_of(program).target);
  own.points = points;
  own.pool = pool;
  const Problem& problem = program.experiment.problems.front();
  Configurations path(2);
  for (const auto& q : {Configuration{2, 5}, Configuration{8, 5}}) path.push(q);
  const Target mine =
      Target::distribution(problem.space, own, own.make({problem, path, std::max(own.points, own.pool), 7}));
  TubeSettings settings;
  settings.support = TubeSettings::Support::all;
  settings.points = points;
  settings.pool = pool;
  const Target tube(problem.space, path, {0, 1}, settings, {}, 7);
  const double exact = std::log(100.0) - std::log(6.0 + std::numbers::pi / 4.0);
  CHECK(mine.uniform() == Approx(exact));
  CHECK(tube.uniform() == Approx(exact).margin(0.01));

  // Samples that crowd about the first half of the path.
  Stream stream(1, "", "test");
  Configurations samples(2);
  for (int i = 0; i < 2000; ++i) {
    samples.push(Configuration{stream.uniform(0, 10) * 0.6, std::clamp(5.0 + stream.normal(), 0.0, 10.0)});
  }
  const Efficiency a = efficiency(mine, samples);
  const Efficiency b = efficiency(tube, samples);
  CHECK(a.in_target == b.in_target);
  CHECK(a.value == Approx(b.value).margin(0.05));
  CHECK(a.unregularised == Approx(b.unregularised).margin(0.05));
  CHECK(a.above_uniform == Approx(b.above_uniform).margin(0.05));
  CHECK(a.mass == Approx(b.mass));
  CHECK(a.coverage == Approx(b.coverage).margin(0.02));
}

TEST_CASE("a user's target scores an experiment, the same each time, after its session is gone", "[slow]") {
  const auto once = load(own_tube + experiment("measure = own, seeds = 2, cross = 1"));
  ExperimentOptions options;
  options.jobs = 2;
  const auto first = run(once.experiment, options);
  const auto second = run(load(own_tube + experiment("measure = own, seeds = 2, cross = 1")).experiment);
  REQUIRE(first.runs.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& level = first.runs[i].levels.front();
    REQUIRE(level.own);
    REQUIRE(level.root_cross);
    CHECK(std::isfinite(level.own->tree.value));
    CHECK(level.own->tree.value == second.runs[i].levels.front().own->tree.value);
    CHECK(level.root_cross->expansion.value == second.runs[i].levels.front().root_cross->expansion.value);
  }
}

TEST_CASE("a user's functions receive the path, the problem and its space") {
  const std::string density = ", log_density = function() return -math.log(100) end";
  const auto value_of = [&](const std::string& what) {
    const std::string message = run_failure("sample = function(c) error(tostring(" + what + "), 0) end" + density);
    const std::string run = "(problem 'room', strategy 'rrt', seed 1): ";
    const auto begin = message.find(run);
    REQUIRE(begin != std::string::npos);
    return message.substr(begin + run.size(), message.find('\n') - begin - run.size());
  };
  CHECK(value_of("c.problem.name") == "room");
  CHECK(value_of("c.problem.goal[1]") == "8.0");
  CHECK(value_of("#c.path >= 2 and c.path[1][1]") == "2.0");
  CHECK(value_of("c.space.name") == "R^2");
  CHECK(value_of("c.space.dimension") == "2");
  CHECK(value_of("table.concat(c.space.names, ' ')") == "x y");
  CHECK(value_of("table.concat(c.space.lower, ' ')") == "0.0 0.0");
  CHECK(value_of("table.concat(c.space.upper, ' ')") == "10.0 10.0");
  CHECK(value_of("table.concat(c.space.weights, ' ')") == "1.0 1.0");
  CHECK(value_of("c.space.periodic[1]") == "false");
  CHECK(value_of("c.valid {1, 1}") == "true");
  CHECK(value_of("c.valid {11, 1}") == "false");
  CHECK(value_of("math.type(c.random(6))") == "integer");
  CHECK(value_of("math.type(c.normal())") == "float");
}

TEST_CASE("an error in a user's function names the function, the draw and the line") {
  const std::string sample = "sample = function(c) return { 10 * c.random(), 10 * c.random() } end, ";
  const std::string density = ", log_density = function() return -math.log(100) end";
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"sample = function() return nil + 1 end" + density,
       "sample, draw 1 of 64 (problem 'room', strategy 'rrt', seed 1): test.lua:2: attempt to perform arithmetic on a "
       "nil value\nstack "
       "traceback:\n"},
      {"sample = function(c) n = rawget(_G, 'n') or 0 rawset(_G, 'n', n + 1) if n == 40 then error('forty') end "
       "return {n / 10, 1} end" +
           density,
       "sample, draw 40 of 64 (problem 'room', strategy 'rrt', seed 1): test.lua:2: forty\nstack traceback:\n"},
      {"sample = function() end" + density,
       "sample, draw 1 of 64 (problem 'room', strategy 'rrt', seed 1): it returned nothing, expected a "
       "configuration"},
      {"sample = function() return 3 end" + density, "what it returns must be a list of numbers, got 3"},
      {"sample = function() return {1} end" + density,
       "what it returns must be a configuration of 2 numbers (x, y), got 1"},
      {"sample = function() return {1, 0/0} end" + density,
       "what it returns must be a list of finite numbers, got nan as number 2"},
      {"sample = function() return {1, 12} end" + density,
       "what it returns must lie in the space R^2: y = 12 is outside of [0, 10]"},
      {"sample = function(c) return c.valid {1} end" + density,
       "valid: its argument must be a configuration of 2 numbers (x, y), got 1"},
      {"sample = function(c) return c.random('a') end" + density, "random: argument 1 must be an integer, got \"a\""},
      {sample + "log_density = function() return nil end", "log_density at draw 1 of 64, ("},
      {sample + "log_density = function() return nil end",
       "it returned nil, expected the logarithm of a density, and -math.huge where there is none"},
      {sample + "log_density = function() return 0/0 end", "it returned nan, expected the logarithm"},
      {sample + "log_density = function() return math.huge end", "it returned inf, expected the logarithm"},
      {sample + "log_density = function() return -math.huge end",
       "it returned -inf where 'sample' draws, expected a finite number"},
      {sample + "log_density = function(q) return q.x.y end", "test.lua:2: attempt to index a nil value (field 'x')"},
  };
  for (const auto& [functions, message] : wrong) {
    INFO(functions);
    const std::string got = run_failure(functions);
    INFO(got);
    CHECK(got.starts_with("test.lua:2: target: "));
    CHECK(got.find(message) != std::string::npos);
  }
}

TEST_CASE("an error in a user's density names the sample and its level") {
  // The density fails when it is called for the n-th time; the draws come first, then each level's samples.
  const auto message = [](int n, const std::string& what) {
    const auto program = load(
        "local n = 0 return experiment { problems = problem { name = 'room', world = world { bounds = {0, 0, 10, 10}, "
        "box {4, 0, 6, 6} }, robot = robot.point(), start = {2, 5}, goal = {8, 5} }, "
        "strategies = { guided = shrink(0.5) >> lazy() >> rrt {} }, measure = target { points = 64, pool = 64, "
        "sample = function(c) return { 10 * c.random(), 10 * c.random() } end, log_density = function() n = n + 1 "
        "if n > " +
        std::to_string(n) + " then " + what + " end return -math.log(100) end } }");
    try {
      run(program.experiment);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(message(0, "error('late')").find("target: log_density at draw 1 of 64, (") != std::string::npos);
  std::string all;
  for (int n = 128; n < 100000; n += 20 + n / 50) {
    const std::string one = message(n, "error('late')");
    if (one.empty()) break;
    CHECK(one.find("(problem 'room', strategy 'guided', seed 1): test.lua:1: late\nstack traceback:\n") !=
          std::string::npos);
    all += one;
  }
  CHECK(all.find(", node ") != std::string::npos);
  CHECK(all.find(", proposal ") != std::string::npos);
  CHECK(all.find(" of rrt, level 0 (") != std::string::npos);
  CHECK(all.find(" of lazy() >> rrt, level 1 (") != std::string::npos);
  CHECK(all.find(" of shrink(0.5) >> lazy() >> rrt, level 2 (") != std::string::npos);

  const std::string endless = message(160, "while true do pcall(error) end");
  CHECK(endless.find(" of rrt, level 0 (problem 'room', strategy 'guided', seed 1): test.lua:1: it has ") !=
        std::string::npos);
  CHECK(endless.find(" and does not terminate; is there an infinite loop?") != std::string::npos);
}

TEST_CASE("help describes targets, estimators and the construct of a user's target") {
  const std::string all = dsl::vocabulary_text();
  for (const char* word :
       {"targets:", "estimators:", "tube", "near_optimal", "progress", "knn", "exact", "arc", "target"}) {
    INFO(word);
    CHECK(all.find(word) != std::string::npos);
  }
  CHECK(dsl::help_text("target").find("context.path") != std::string::npos);
  CHECK(dsl::help_text("experiment").find("  ablate ") != std::string::npos);
  CHECK_THROWS_WITH(dsl::help_text("near_optimum"), Catch::Contains("did you mean 'near_optimal'?"));
}
