// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/experiment.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include <dsl/language/core/nested_lists.hpp>
#include <dsl/language/words/algebra.hpp>
#include <trellis/experiment/baseline.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

struct ExperimentSettings {
  std::int64_t seed = 1;
  std::int64_t shortcut = 0;
  double ablation = default_ablation;
  std::int64_t cross = Measure{}.cross;
  bool cross_levels = Measure{}.cross_levels;
  bool metrics = Measure{}.metrics;
};

const Settings<ExperimentSettings>& experiment_settings() {
  static const auto settings =
      Settings<ExperimentSettings>(Component::Kind::target, "experiment", "problems x strategies x seeds", "")
          .integer("seed", &ExperimentSettings::seed, "", Range::non_negative(),
                   "the first of consecutive seeds, where 'seeds' is their number")
          .integer("shortcut", &ExperimentSettings::shortcut, "rounds", Range::non_negative(),
                   "rounds of shortcutting on each found path before it is reported")
          .number("ablation", &ExperimentSettings::ablation, "times the experiment's work", Range::at_least(0),
                  "the work that may be spent on the verdicts on levels: runs of each strategy without each of its "
                  "guides, unscored, in validity checks; a scored run counts 20 000 more. As much again for the "
                  "verdicts on the robots of a team. 0: no verdicts but those of the experiment's own strategies")
          .integer("cross", &ExperimentSettings::cross, "paths", Range::non_negative(),
                   "paths of other seeds that each run is scored on besides its own")
          .boolean("cross_levels", &ExperimentSettings::cross_levels,
                   "whether lower levels are scored on the paths of other seeds in their own spaces too, not only "
                   "lifted to the root's")
          .boolean("metrics", &ExperimentSettings::metrics,
                   "whether each level's roadmap, information and wasted samples are measured too");
  return settings;
}

/// Warns of a field `seed` that runs one seed, or changes nothing.
void warn_of_seed(const Arguments& arguments, Program& program, Stack& call) {
  const Value seeds = arguments["seeds"];
  if (program.seed == 1 || !arguments["seed"].given() || seeds.type() == Type::number) return;
  const auto position = call.where();
  program.warnings.push_back(fmt::format(
      "{}experiment: {}", position ? position->prefix() : "",
      seeds.given()
          ? fmt::format("seed = {} has no effect beside a list of seeds", program.seed)
          : fmt::format("seed = {0} runs the seed {0} alone; seeds = {0} runs the seeds 1 to {0}", program.seed)));
}

/// Reads problems from a problem, a list of problems, and nested lists, in order.
class ProblemReader {
 public:
  explicit ProblemReader(const std::string& prefix = "experiment: ") : prefix_(prefix), lists_(prefix, most_values) {}

  void read(const std::string& what, Value value) {
    if (!lists_.count() || faults_ == most_faults) return;
    if (const auto* problem = value.get<Problem>()) {
      problems_.push_back(*problem);
      return;
    }
    if (value.type() != Type::table) {
      ++faults_;
      throw Error(fmt::format("{}{} must be a problem or a list of problems, got {}{}", prefix_, what, describe(value),
                              value.type() == Type::function ? "; call it, as scenes.trap()" : ""));
    }
    const auto within = lists_.enter(value, what);
    const lua::Keys keys = value.keys();
    if (!keys.names.empty() || !keys.odd.empty()) {
      throw Error(fmt::format("{}{} must be a problem or a list of problems, got a table with {}", prefix_, what,
                              keys.names.empty() ? keys.odd : "the field '" + keys.names.front() + "'"));
    }
    lua::Faults faults;
    value.each([&](std::size_t i, Value element) {
      faults.attempt([&] { read(fmt::format("element {} of {}", i, what), element); });
    });
    faults.raise();
  }

  std::vector<Problem> take() { return std::move(problems_); }

 private:
  static constexpr std::size_t most_values = 100'000;
  static constexpr std::size_t most_faults = 1000;  // then the list is something else

  std::string prefix_;
  std::vector<Problem> problems_;
  std::size_t faults_ = 0;
  NestedLists lists_;
};

/// Reads a strategy, or throws an error that states the missing part. `container`: its table.
StrategySpec read_strategy(const std::string& what, Value value, const void* container) {
  if (auto strategy = as_strategy(value)) return *strategy;
  if (value.get<GuideSpec>() != nullptr) {
    throw Error(fmt::format("{} has no planner at its root: {} only guides; end it with >> rrt {{}} or another planner",
                            what, describe(value)));
  }
  const bool cycle = value.type() == Type::table && value.identity() == container;
  throw Error(fmt::format("{} must be a strategy, as guide >> planner, or a planner, got {}", what,
                          cycle ? "the table that it stands in (a cycle)" : describe(value)));
}

std::vector<EstimatorSpec> read_estimators(const Arguments& arguments) {
  const Value value = arguments["estimators"];
  if (!value.given()) return default_estimators();
  if (const auto* one = value.get<EstimatorSpec>()) return {*one};
  if (value.type() != Type::table) arguments.reject("estimators");
  const lua::Keys keys = value.keys();
  if (!keys.names.empty() || !keys.odd.empty() || keys.length == 0) {
    throw Error(fmt::format("experiment: field 'estimators' must be a list of estimators, got {}",
                            !keys.odd.empty()    ? "one with " + keys.odd
                            : keys.names.empty() ? "an empty one"
                                                 : "one with the field '" + keys.names.front() + "'"));
  }
  std::vector<EstimatorSpec> estimators;
  value.each([&](std::size_t i, Value element) {
    const auto* estimator = element.get<EstimatorSpec>();
    if (estimator == nullptr) {
      throw Error(fmt::format("experiment: element {} of field 'estimators' must be an estimator, as knn {{}}, got {}",
                              i, describe(element)));
    }
    if (std::find(estimators.begin(), estimators.end(), *estimator) != estimators.end()) {
      throw Error(fmt::format("experiment: field 'estimators' holds {} twice", estimator->text()));
    }
    estimators.push_back(*estimator);
  });
  return estimators;
}

std::optional<Measure> read_measure(const Arguments& arguments, const ExperimentSettings& settings) {
  Measure measure;
  measure.estimators = read_estimators(arguments);
  measure.cross = settings.cross;
  measure.cross_levels = settings.cross_levels;
  measure.metrics = settings.metrics;
  const Value value = arguments["measure"];
  if (!value.given()) return measure;
  if (const auto* target = value.get<TargetSpec>()) {
    measure.target = *target;
    return measure;
  }
  if (value.boolean() != false) arguments.reject("measure");
  for (const char* name : {"estimators", "cross", "cross_levels", "metrics"}) {
    if (!arguments[name].given()) continue;
    throw Error(
        fmt::format("experiment: field '{}' says how samples are measured, and 'measure = false' that they are "
                    "not; leave one of them out",
                    name));
  }
  return std::nullopt;
}

void read_ablate(const Arguments& arguments, Experiment& experiment) {
  const Value value = arguments["ablate"];
  if (!value.given() || value.boolean() == false) return;
  if (value.boolean() == true) {
    ablate_all(experiment, "experiment: field 'ablate'");
    return;
  }
  if (value.type() != Type::table) arguments.reject("ablate");
  const lua::Keys keys = value.keys();
  if (!keys.names.empty() || !keys.odd.empty()) arguments.reject("ablate");
  std::vector<std::string> names;
  value.each([&](std::size_t i, Value element) {
    const auto name = element.string();
    if (!name) {
      throw Error(fmt::format("experiment: field 'ablate' must hold names of strategies, got {} as number {}",
                              describe(element), i));
    }
    if (std::find(names.begin(), names.end(), *name) != names.end()) {
      throw Error(fmt::format("experiment: field 'ablate' names the strategy '{}' twice", *name));
    }
    names.push_back(*name);
  });
  ablate(experiment, names);
}

/// One group: { "paper", problems, tuned = true }.
ProblemGroup read_group(Value value, const std::string& what) {
  const lua::Keys keys = value.type() == Type::table ? value.keys() : lua::Keys{};
  const bool named = keys.names.empty() || keys.names == std::vector<std::string>{"tuned"};
  if (keys.length != 2 || !named || !keys.odd.empty()) {
    throw Error(fmt::format("experiment: {} must be {{ \"name\", problems }}, perhaps with tuned = true, got {}", what,
                            describe(value)));
  }
  ProblemGroup group;
  value.each([&](std::size_t i, Value part) {
    if (i == 1) {
      group.name = part.string().value_or("");
      if (group.name.empty()) throw Error(fmt::format("experiment: the name of {} must be a string", what));
      return;
    }
    ProblemReader problems;
    problems.read("the second element of " + what, part);
    for (const Problem& problem : problems.take()) group.problems.push_back(problem.name);
  });
  const Value tuned = value.field("tuned");
  if (tuned.given()) {
    const auto given = tuned.boolean();
    if (!given) throw Error(fmt::format("experiment: field 'tuned' of {} must be true or false", what));
    group.tuned = *given;
  }
  return group;
}

void read_groups(const Arguments& arguments, Experiment& experiment) {
  const Value value = arguments["groups"];
  if (!value.given()) return;
  const lua::Keys keys = value.type() == Type::table ? value.keys() : lua::Keys{};
  if (value.type() != Type::table || !keys.names.empty() || !keys.odd.empty()) arguments.reject("groups");
  std::map<std::string, std::string> group_of;
  value.each([&](std::size_t i, Value element) {
    ProblemGroup group = read_group(element, fmt::format("element {} of field 'groups'", i));
    for (const std::string& name : group.problems) {
      const bool known = std::any_of(experiment.problems.begin(), experiment.problems.end(),
                                     [&](const Problem& problem) { return problem.name == name; });
      if (!known) {
        throw Error(fmt::format("experiment: group '{}' holds the problem '{}', which is not in field 'problems'",
                                group.name, name));
      }
      const auto [other, first] = group_of.emplace(name, group.name);
      if (!first) {
        throw Error(
            fmt::format("experiment: problem '{}' is in the groups '{}' and '{}'", name, other->second, group.name));
      }
    }
    experiment.groups.push_back(std::move(group));
  });
}

/// Checks the baseline of an experiment with other faults, which `check` does not see.
void check_baseline(const Arguments& arguments, const std::string& baseline, lua::Faults& faults) {
  const Value strategies = arguments["strategies"];
  if (baseline.empty() || strategies.type() != Type::table) return;
  const lua::Keys keys = strategies.keys();
  if (keys.length > 0 || keys.names.empty()) return;
  if (std::find(keys.names.begin(), keys.names.end(), baseline) != keys.names.end()) return;
  faults.add(unknown_baseline(baseline, keys.names));
}

/// Reads how the runs are scored and compared.
void read_comparison(const Arguments& arguments, Experiment& experiment, lua::Faults& faults) {
  faults.attempt([&] {
    experiment.baseline = arguments.string("baseline").value_or("");
    if (experiment.baseline.empty() && arguments["baseline"].given()) arguments.reject("baseline");
  });
}

int make_experiment(Stack& call) {
  lua::Faults faults;
  const Arguments arguments(experiment_construct(), call, faults);
  if (!arguments.readable()) faults.raise();
  ExperimentSettings settings;
  const bool valid = faults.attempt([&] { settings = experiment_settings().read(arguments.options()); });
  Program program;
  program.seed = static_cast<std::uint64_t>(settings.seed);
  Experiment& experiment = program.experiment;
  experiment.shortcut = settings.shortcut;
  experiment.ablation = settings.ablation;
  bool problems_read = false, strategies_read = false;
  if (const Value given = arguments["problems"]; given.given()) {
    ProblemReader problems;
    problems_read = faults.attempt([&] { problems.read("field 'problems'", given); });
    experiment.problems = problems.take();
  }
  if (arguments["strategies"].given()) {
    strategies_read = faults.attempt([&] { experiment.strategies = read_strategies(arguments, "experiment"); });
  }
  faults.attempt([&] { experiment.seeds = read_seeds(arguments, "experiment", program.seed, 1); });
  warn_of_seed(arguments, program, call);
  if (valid) {
    faults.attempt([&] { experiment.measure = read_measure(arguments, settings); });
  }
  read_comparison(arguments, experiment, faults);
  if (problems_read) {
    faults.attempt([&] { read_groups(arguments, experiment); });
  }
  if (strategies_read) {
    faults.attempt([&] { read_ablate(arguments, experiment); });
  }
  if (!faults.none()) check_baseline(arguments, experiment.baseline, faults);
  faults.raise();
  check(experiment);
  return call.result(std::move(program));
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

int experiment_text(Stack& call) {
  const auto* program = call[1].get<Program>();
  if (program == nullptr) return call.result(call[1].describe());
  const Experiment& experiment = program->experiment;
  return call.result(fmt::format("{} of {}, {}, {}", program->tuning ? "tuning" : "experiment",
                                 counted(experiment.problems.size(), "problem", "problems"),
                                 counted(experiment.strategies.size(), "strategy", "strategies"),
                                 counted(experiment.seeds.size(), "seed", "seeds")));
}

/// experiment { ... }.strategies, .problems, .seeds.
int experiment_field(Stack& call) {
  static const std::vector<std::string> fields = {"problems", "seeds", "strategies"};
  const auto* program = call[1].get<Program>();
  const auto name = call[2].string();
  if (program == nullptr || !name || std::find(fields.begin(), fields.end(), *name) == fields.end()) {
    throw Error(fmt::format("an experiment has no field {}{}; it has: {}", call[2].describe(),
                            name ? did_you_mean(*name, fields) : "", fmt::join(fields, ", ")));
  }
  const Experiment experiment = program->experiment;
  const Value table = push_experiment(call, experiment);
  static_cast<void>(table.field(*name));
  return 1;
}

Program single(StrategySpec strategy, const std::function<void(ProblemReader&)>& read) {
  ProblemReader problems;
  read(problems);
  Program program;
  program.experiment.problems = problems.take();
  program.experiment.strategies.emplace_back("strategy", std::move(strategy));
  program.experiment.seeds = consecutive_seeds(program.seed, 1);
  program.experiment.ablation = default_ablation;
  check(program.experiment);
  return program;
}

}  // namespace

std::vector<Problem> read_problem_list(const std::string& prefix, const std::string& what, Value value) {
  ProblemReader reader(prefix);
  reader.read(what, value);
  return reader.take();
}

Value push_experiment(Stack& stack, const Experiment& experiment) {
  const Value table = stack.push_table();
  const Value strategies = stack.push_table();
  for (const auto& [name, strategy] : experiment.strategies) {
    stack.push_object(strategy);
    stack.set_field(strategies, name);
  }
  stack.set_field(table, "strategies");
  const Value problems = stack.push_table();
  for (const Problem& problem : experiment.problems) {
    stack.push_object(problem);
    stack.append(problems);
    stack.push_object(problem);
    stack.set_field(problems, problem.name);
  }
  stack.set_field(table, "problems");
  const Value seeds = stack.push_table();
  for (const std::uint64_t seed : experiment.seeds) {
    stack.push(static_cast<std::int64_t>(seed));
    stack.append(seeds);
  }
  stack.set_field(table, "seeds");
  return table;
}

std::vector<std::pair<std::string, StrategySpec>> read_strategies(const Arguments& arguments, const std::string& of) {
  const Value table = arguments["strategies"];
  if (table.type() != Type::table) arguments.reject("strategies");
  const lua::Keys keys = table.keys();
  if (!keys.odd.empty()) {
    throw Error(fmt::format("{}: field 'strategies' maps names to strategies, got {}", of, keys.odd));
  }
  std::vector<std::pair<std::string, StrategySpec>> strategies;
  lua::Faults faults;
  const auto read = [&](std::size_t i, Value element) {
    const std::string what = fmt::format("{}: strategy {}", of, i);
    if (element.type() != Type::table) {
      auto strategy = read_strategy(what, element, table.identity());
      std::string text = strategy.text();
      strategies.emplace_back(std::move(text), std::move(strategy));
      return;
    }
    const lua::Keys pair = element.keys();
    const bool is_pair = pair.length == 2 && pair.names.empty() && pair.odd.empty();
    std::vector<Value> values;
    std::optional<std::string> name;
    std::optional<StrategySpec> strategy;
    if (is_pair) {
      element.each([&](std::size_t k, Value part) {
        if (k == 1) {
          name = part.string();
        } else if (name) {
          strategy = read_strategy(fmt::format("{}: strategy '{}'", of, *name), part, table.identity());
        }
      });
    }
    if (!name || !strategy) {
      throw Error(fmt::format(
          "{} must be a strategy or a pair {{\"name\", strategy}}, got {}", what,
          element.identity() == table.identity() ? "the table that it stands in (a cycle)" : describe(element)));
    }
    strategies.emplace_back(*name, std::move(*strategy));
  };
  table.each([&](std::size_t i, Value element) { faults.attempt([&] { read(i, element); }); });
  std::vector<std::pair<std::uint64_t, std::string>> names;  // in the order in which the script makes the strategies
  for (const auto& name : keys.names) names.emplace_back(table.field(name).object_number(), name);
  std::sort(names.begin(), names.end());
  for (const auto& entry : names) {
    const std::string& name = entry.second;
    faults.attempt([&] {
      strategies.emplace_back(
          name, read_strategy(fmt::format("{}: strategy '{}'", of, name), table.field(name), table.identity()));
    });
  }
  faults.raise();
  return strategies;
}

std::vector<std::uint64_t> read_seeds(const Arguments& arguments, const std::string& of, std::uint64_t first,
                                      std::uint64_t otherwise) {
  const Value value = arguments["seeds"];
  if (!value.given()) return consecutive_seeds(first, otherwise);
  if (value.type() == Type::number) {
    const auto count = value.integer();
    if (!count || *count < 1 || static_cast<std::uint64_t>(*count) > most_seeds) arguments.reject("seeds");
    return consecutive_seeds(first, static_cast<std::uint64_t>(*count));
  }
  if (value.type() != Type::table) arguments.reject("seeds");
  const lua::Keys keys = value.keys();
  if (!keys.names.empty() || !keys.odd.empty()) arguments.reject("seeds");
  std::vector<std::uint64_t> seeds;
  value.each([&](std::size_t i, Value element) {
    const auto seed = element.integer();
    if (!seed || *seed < 0) {
      throw Error(fmt::format("{}: field 'seeds' must hold integers of at least 0, got {} as number {}", of,
                              describe(element), i));
    }
    seeds.push_back(static_cast<std::uint64_t>(*seed));
  });
  return seeds;
}

const Construct& experiment_construct() {
  static const Construct construct = {
      .name = "experiment",
      .usage = "experiment { problems = {p}, strategies = { plain = rrt {} }, seeds = 15, measure = tube {} }",
      .summary = "problems x strategies x seeds, and how they are scored",
      .list = "",
      .element = "",
      .fields =
          {{"problems", "trellis.Problem|(trellis.Problem|trellis.Problem[])[]", "a problem or a list of problems",
            "lists in the list are opened", true},
           {"strategies", "table<string, trellis.Strategy>|(trellis.Strategy|{ [1]: string, [2]: trellis.Strategy })[]",
            "a table of strategies",
            "{ name = strategy }, reported in the order in which the script makes them, or a list of strategies or of "
            "pairs {\"name\", strategy}, reported in its order",
            true},
           {"seeds", "integer|integer[]", fmt::format("an integer in [1, {}], or a list of seeds", most_seeds),
            "how many consecutive seeds, or which ones", false, "1"},
           {"measure", "trellis.Target|false", "a target, as tube { delta = 0.5 }, or false",
            "what samples are measured against; false computes no efficiency", false, "tube {}"},
           {"estimators", "trellis.Estimator|trellis.Estimator[]",
            "an estimator or a list of estimators, as { exact(), knn { k = 3 } }",
            "the first that has a figure gives the headline; of a list that is given, the others stand beside it",
            false, "{ exact(), arc(), knn() }"},
           {"baseline", "string", "the name of a strategy",
            "what the others are compared with; by default the first strategy without a guide, else the first"},
           {"groups", "table[]", "a list of groups, as { { \"mazes\", {p, q}, tuned = true } }",
            "problems that trellis report lists together; tuned: whether the strategies were tuned on them (false)"},
           {"ablate", "boolean|string[]", "true, or a list of names of strategies",
            "adds each strategy that has a guide, or each that is named, with every guide taken out in turn, as "
            "strategies of the report: they are scored, and without a budget",
            false, "false"}},
      .options = experiment_settings().component(),
      .returns = "trellis.Experiment"};
  return construct;
}

Program read_program(Stack& stack, int first) {
  const int count = stack.size() - first + 1;
  const std::string offer = "end it with 'return experiment { ... }' or 'return strategy, problem'";
  const Value value = stack[first];
  if (count < 1 || !value.given()) throw Error("the script returns nothing; " + offer);
  if (const auto* program = value.get<Program>()) {
    if (count > 1) throw Error(fmt::format("the script returns {} values; an experiment stands alone", count));
    return *program;
  }
  if (value.type() == Type::table && count == 1) {
    const lua::Keys keys = value.keys();
    if (keys.names == std::vector<std::string>{"problem", "strategy"} && keys.length == 0 && keys.odd.empty()) {
      auto strategy =
          read_strategy("field 'strategy' of what the script returns", value.field("strategy"), value.identity());
      return single(std::move(strategy),
                    [&](ProblemReader& reader) { reader.read("field 'problem'", value.field("problem")); });
    }
    throw Error("the script returns a table that is no { strategy = ..., problem = ... }; " + offer);
  }
  if (value.get<GuideSpec>() != nullptr || as_strategy(value)) {
    auto strategy = read_strategy("the strategy that the script returns", value, nullptr);
    if (count != 2) {
      throw Error(fmt::format("the script returns a strategy with {}; {}",
                              count == 1 ? "no problem" : "more than a problem", offer));
    }
    return single(std::move(strategy),
                  [&](ProblemReader& reader) { reader.read("what follows the strategy", stack[first + 1]); });
  }
  throw Error(fmt::format("the script returns {}; {}", describe(value), offer));
}

std::vector<Problem> read_problems(Stack& stack, int first) {
  const int count = stack.size() - first + 1;
  if (count != 1 || !stack[first].given()) {
    throw Error(fmt::format("the script returns {}, expected a problem, as 'return scenes.cup()'",
                            count > 1 ? fmt::format("{} values", count) : "nothing"));
  }
  ProblemReader reader("");
  reader.read("what the script returns", stack[first]);
  return reader.take();
}

void open_experiment(Stack& stack) {
  stack.declare<Program>({{"__tostring", experiment_text}, {"__index", experiment_field}});
  stack.push_function(make_experiment);
  stack.set_global(experiment_construct().name);
}

}  // namespace trellis::dsl
