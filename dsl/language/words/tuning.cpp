// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/tuning.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <dsl/language/core/types.hpp>
#include <dsl/language/words/algebra.hpp>
#include <dsl/language/words/experiment.hpp>
#include <dsl/lua/state.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

constexpr std::size_t most_combinations = 1000;

struct TuneOptions {
  std::int64_t budget = 200;
  std::int64_t seed = 1;
  TuneBy by = TuneBy::checks;
};

const Settings<TuneOptions>& tune_settings() {
  static const auto settings =
      Settings<TuneOptions>(Component::Kind::target, "tune", "selects the best values of a strategy", "")
          .integer("budget", &TuneOptions::budget, "runs", Range{.lo = 1, .hi = 1e9},
                   "the largest number of runs; a quarter of them, or more, are for seeds that nothing is selected on")
          .integer("seed", &TuneOptions::seed, "", Range::non_negative(), "the first of consecutive seeds")
          .choice("by", &TuneOptions::by,
                  {{"checks", TuneBy::checks}, {"time", TuneBy::time}, {"length", TuneBy::length}},
                  "the cost: validity checks of all levels, CPU time (differs from run to run), or length of the path");
  return settings;
}

/// A name of `over` with its values.
struct Choice {
  std::string name;
  std::vector<std::shared_ptr<const lua::Reference>> values;
  std::vector<std::string> texts;  ///< in the syntax of a script
};

std::string text_of(Value value) {
  if (const auto* guide = value.get<GuideSpec>()) return guide->text();
  if (const auto strategy = as_strategy(value)) return strategy->text();
  return value.describe();
}

Choice read_choice(Stack& call, const std::string& name, Value list) {
  const lua::Keys keys = list.type() == Type::table ? list.keys() : lua::Keys{};
  if (list.type() != Type::table || keys.length == 0 || !keys.names.empty() || !keys.odd.empty()) {
    throw Error(
        fmt::format("tune: over.{0} must be a list of values, as {0} = {{ 0.2, 0.4 }}, got {1}", name, describe(list)));
  }
  Choice choice = {.name = name, .values = {}, .texts = {}};
  list.each([&](std::size_t i, Value value) {
    const Type type = value.type();
    if (type == Type::table || type == Type::function || type == Type::other) {
      throw Error(
          fmt::format("tune: over.{} must hold numbers, strings, booleans, guides or planners, got {} as number "
                      "{}",
                      name, describe(value), i));
    }
    std::string text = text_of(value);
    if (std::find(choice.texts.begin(), choice.texts.end(), text) != choice.texts.end()) {
      throw Error(fmt::format("tune: over.{} holds {} twice", name, text));
    }
    choice.texts.push_back(std::move(text));
    choice.values.push_back(std::make_shared<lua::Reference>(call, value));
  });
  return choice;
}

std::vector<Choice> read_over(Stack& call, Value over) {
  const lua::Keys keys = over.type() == Type::table ? over.keys() : lua::Keys{};
  if (keys.names.empty() || keys.length > 0 || !keys.odd.empty()) {
    throw Error(
        fmt::format("tune: field 'over' must be a table of lists, as over = {{ radius = {{ 0.2, 0.4 }} }}, got "
                    "{}",
                    over.given() ? describe(over) : "nothing"));
  }
  std::vector<Choice> choices;
  std::size_t combinations = 1;
  for (const auto& name : keys.names) {
    choices.push_back(read_choice(call, name, over.field(name)));
    combinations *= choices.back().values.size();
    if (combinations > most_combinations) {
      throw Error(fmt::format("tune: field 'over' has more than {} combinations of values; shorten its lists",
                              most_combinations));
    }
  }
  if (combinations < 2) throw Error("tune: field 'over' has one combination of values; nothing is to be selected");
  return choices;
}

/// Calls the function with every combination of values. The last name varies fastest; the first combination has the
/// first value of each list.
class Combinations {
 public:
  Combinations(Stack& call, Value function, const std::vector<Choice>& choices)
      : call_(call), function_(function), choices_(choices), read_(std::make_shared<std::set<std::string>>()) {}

  std::vector<std::pair<std::string, StrategySpec>> make() {
    std::vector<std::pair<std::string, StrategySpec>> all;
    std::vector<std::size_t> at(choices_.size(), 0);
    for (bool more = true; more; more = next(at)) {
      std::string text = text_of_values(at);
      StrategySpec strategy = call_with(at, text);
      all.emplace_back(std::move(text), std::move(strategy));
    }
    for (const Choice& choice : choices_) {
      if (read_->contains(choice.name)) continue;
      throw Error(fmt::format("tune: field 'over' lists '{}', which the function does not read", choice.name));
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (all[i].second == all[j].second) {
          throw Error(fmt::format("tune: {} and {} give the same strategy, {}", all[j].first, all[i].first,
                                  all[i].second.text()));
        }
      }
    }
    return all;
  }

 private:
  bool next(std::vector<std::size_t>& at) const {
    for (std::size_t i = at.size(); i-- > 0;) {
      if (++at[i] < choices_[i].values.size()) return true;
      at[i] = 0;
    }
    return false;
  }

  [[nodiscard]] std::string text_of_values(const std::vector<std::size_t>& at) const {
    std::vector<std::string> parts;
    parts.reserve(at.size());
    for (std::size_t i = 0; i < at.size(); ++i) {
      parts.push_back(fmt::format("{} = {}", choices_[i].name, choices_[i].texts[at[i]]));
    }
    return fmt::format("{}", fmt::join(parts, ", "));
  }

  /// Calls the function with a table that provides the values, and reports unknown names.
  StrategySpec call_with(const std::vector<std::size_t>& at, const std::string& text) {
    using Named = std::pair<std::string, std::shared_ptr<const lua::Reference>>;
    const auto values = std::make_shared<std::vector<Named>>();
    for (std::size_t i = 0; i < at.size(); ++i) values->emplace_back(choices_[i].name, choices_[i].values[at[i]]);
    const int before = call_.size();
    call_.push(function_);
    const Value table = call_.push_table();
    call_.on_missing(table, [values, read = read_](Stack& use) {
      const std::string name = use[2].string().value_or("");
      for (const auto& [known, value] : *values) {
        if (known != name) continue;
        read->insert(name);
        value->push(use);
        return 1;
      }
      std::vector<std::string> names;
      for (const auto& entry : *values) names.push_back(entry.first);
      throw Error(fmt::format("tune: field 'over' has no '{}'{}; it has: {}", name, did_you_mean(name, names),
                              fmt::join(names, ", ")));
    });
    call_.call(1);
    const Value made = call_.size() > before ? call_.top() : call_[call_.size() + 1];
    auto strategy = as_strategy(made);
    if (!strategy) {
      throw Error(fmt::format("tune: the function must return a strategy, as guide >> planner, got {} for {}{}",
                              describe(made), text,
                              made.get<GuideSpec>() != nullptr ? "; end it with >> rrt {} or another planner" : ""));
    }
    call_.resize(before);
    return std::move(*strategy);
  }

  Stack& call_;
  Value function_;
  const std::vector<Choice>& choices_;
  std::shared_ptr<std::set<std::string>> read_;  ///< names that the function has read
};

void check_names(Value table) {
  std::vector<std::string> known = {"over"};
  for (const Option& option : tune_settings().component().options) known.push_back(option.name);
  const lua::Keys keys = table.keys();
  if (keys.length > 0 || !keys.odd.empty()) throw Error("tune: fields have names, as in { over = { ... } }");
  for (const auto& name : keys.names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw Error(fmt::format("tune: unknown field '{}'{}; its fields are: {}", name, did_you_mean(name, known),
                            fmt::join(known, ", ")));
  }
}

}  // namespace

const Construct& tune_construct() {
  static const Construct construct = {
      .name = "tune",
      .usage =
          "tune(function(p) return shrink(p.scale) >> rrt {} end, scenes.cup(), { over = { scale = { 0.4, 0.6 } } "
          "})",
      .summary =
          "selects the best values of a strategy by successive halving over seeds; trellis tune runs it, in a "
          "session it runs at once",
      .list = "",
      .element = "",
      .fields = {{"over", "table<string, any[]>", "a table of lists",
                  "{ name = { value, ... } }: the values of p.name; the first of each list is the start", true}},
      .options = tune_settings().component(),
      .returns = "trellis.Experiment",
      .arguments = {{"strategy", "fun(p: table): trellis.Strategy", "a function of a table of values",
                     "returns the strategy that has these values", true},
                    {"problems", "trellis.Problem|(trellis.Problem|trellis.Problem[])[]",
                     "a problem or a list of problems", "lists in the list are opened", true}},
      .source = "Jamieson and Talwalkar 2016, Non-stochastic best arm identification and hyperparameter optimization"};
  return construct;
}

Program read_tuning(Stack& call) {
  if (call[1].type() != Type::function) {
    throw Error(
        fmt::format("tune: a function of a table of values belongs here, as function(p) return shrink(p.scale) "
                    ">> rrt {{}} end, got {}",
                    describe(call[1])));
  }
  if (call[3].type() != Type::table || call.count() > 3) {
    throw Error(
        fmt::format("tune: after the problems a table belongs, as {{ over = {{ scale = {{ 0.4, 0.6 }} }} }}, "
                    "got {}",
                    call.count() > 3 ? fmt::format("{} arguments", call.count()) : describe(call[3])));
  }
  check_names(call[3]);
  std::vector<Options::Entry> given;
  for (const Option& option : tune_settings().component().options) {
    const Value value = call[3].field(option.name);
    if (value.given()) read_option(tune_settings().component(), option.name, value, given);
  }
  const auto settings = tune_settings().read(Options::validate(tune_settings().component(), given));
  Program program;
  program.seed = static_cast<std::uint64_t>(settings.seed);
  Experiment& experiment = program.experiment;
  experiment.problems = read_problem_list("tune: ", "the second argument", call[2]);
  const std::vector<Choice> choices = read_over(call, call[3].field("over"));
  experiment.strategies = Combinations(call, call[1], choices).make();
  experiment.seeds = consecutive_seeds(program.seed, 1);
  experiment.baseline = experiment.strategies.front().first;
  program.tuning = {settings.by, static_cast<std::uint64_t>(settings.budget), program.seed};
  check(experiment);
  return program;
}

void open_tuning(Stack& stack) {
  stack.push_function([](Stack& call) { return call.result(read_tuning(call)); });
  stack.set_global(tune_construct().name);
}

}  // namespace trellis::dsl
