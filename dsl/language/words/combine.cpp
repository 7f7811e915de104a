// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/combine.hpp>

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <utility>

#include <trellis/strategy/combinator_settings.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

constexpr std::size_t most_components = 1000;

Construct guides(const Component& component, std::string usage, std::string summary) {
  return {.name = component.name,
          .usage = std::move(usage),
          .summary = std::move(summary),
          .list = "guides",
          .element = "trellis.Guide",
          .fields = {},
          .options = component,
          .returns = "trellis.Guide"};
}

const Construct& sequence_construct() {
  static const Construct construct = guides(
      sequence_settings().component(), "sequence { a, b, turn = 200 }",
      "guides that take turns; the search of each space goes by the path and the refuted places of the one before; "
      "a .. b is sequence { a, b }");
  return construct;
}

const Construct& blend_construct() {
  static const Construct construct =
      guides(blend_settings().component(), "blend { skeleton(), shrink(0.5), floor = 0.2 }",
             blend_settings().component().summary);
  return construct;
}

const Construct& schedule_construct() {
  static const Construct construct =
      guides(schedule_settings().component(), "schedule { shrink(0.3), shrink(0.6), rounds = 2 }",
             schedule_settings().component().summary +
                 "; schedule { shrink, scale = {0.3, 0.6} } is one guide with its options' values in turn");
  return construct;
}

const Construct& race_construct() {
  static const Construct construct = guides(race_settings().component(), "race { lazy(), shrink(0.5), slice = 50 }",
                                            race_settings().component().summary);
  return construct;
}

const Construct& split_construct() {
  static const Construct construct = {
      .name = split_settings().component().name,
      .usage = "skeleton() >> split { rrt {}, depth = 2 }",
      .summary = split_settings().component().summary + "; split { guide >> planner } is guide >> split { planner }",
      .list = "one planner, or a strategy",
      .element = "trellis.Strategy",
      .fields = {},
      .options = split_settings().component(),
      .returns = "trellis.Planner"};
  return construct;
}

/// Reads the guides of a combinator.
std::vector<GuideSpec> read_parts(const char* name, const Arguments& arguments) {
  std::vector<GuideSpec> parts;
  std::size_t components = 0;
  lua::Faults faults;
  arguments.each([&](std::size_t i, Value value) {
    faults.attempt([&] {
      const auto* guide = value.get<GuideSpec>();
      if (guide == nullptr) {
        throw Error(fmt::format("{}: element {} must be a guide, got {}", name, i, describe(value)));
      }
      parts.push_back(*guide);
      components += components_of(*guide);
    });
  });
  faults.raise();
  if (parts.empty()) throw Error(fmt::format("{}: it needs at least one guide", name));
  check_size(components);
  return parts;
}

int make_sequence(Stack& call) {
  const Arguments arguments(sequence_construct(), call);
  return call.result(sequence(read_parts("sequence", arguments), sequence_settings().read(arguments.options()).turn));
}

int make_blend(Stack& call) {
  const Arguments arguments(blend_construct(), call);
  return call.result(blend(read_parts("blend", arguments), blend_settings().read(arguments.options())));
}

int make_race(Stack& call) {
  const Arguments arguments(race_construct(), call);
  return call.result(race(read_parts("race", arguments), race_settings().read(arguments.options())));
}

/// schedule { shrink, scale = {0.3, 0.6}, evidence = 50 }: a guide with a sequence of values of an option. An option
/// with one value has it in every round.
class Rounds {
 public:
  Rounds(const Component& guide, Value table) : guide_(guide), table_(table) {
    const lua::Keys keys = table.keys();
    if (!keys.odd.empty()) throw Error(fmt::format("schedule: options are named; got {}", keys.odd));
    if (keys.length > 1) {
      throw Error(
          fmt::format("schedule: after the constructor '{}' options with their values follow, as {} = {{...}}; "
                      "call it to give guides one by one",
                      guide.name, guide.options.empty() ? "option" : guide.options.front().name));
    }
    for (const auto& name : keys.names) read(name);
    if (rounds_ == 0) {
      throw Error(
          fmt::format("schedule: at least one option of '{}' must have a list of values, one for each round; "
                      "to use the guide once, call it: {}()",
                      guide.name, guide.name));
    }
  }

  [[nodiscard]] std::vector<GuideSpec> guides(const Origin& origin, const ScriptPlace& place) const {
    std::vector<GuideSpec> parts;
    parts.reserve(rounds_);
    for (std::size_t round = 0; round < rounds_; ++round) {
      std::vector<Options::Entry> given = each_;
      for (const auto& [name, values] : lists_) given.push_back(values[round]);
      place_files(guide_, given, place);
      parts.push_back(GuideSpec::make(guide_.name, given, planner_, origin));
    }
    return parts;
  }
  /// The options of the schedule itself.
  [[nodiscard]] Options options() const { return Options::validate(schedule_settings().component(), own_); }

 private:
  void read(const std::string& name) {
    const Value value = table_.field(name);
    if (name == "planner") {
      const auto* planner = value.get<PlannerSpec>();
      if (planner == nullptr) {
        throw Error(fmt::format("schedule: option 'planner' must be a planner, got {}", describe(value)));
      }
      planner_ = *planner;
      return;
    }
    const Option* option = guide_.find(name);
    if (option == nullptr && schedule_settings().component().find(name) != nullptr) {
      read_option(schedule_settings().component(), name, value, own_);
      return;
    }
    // A list of names is one value.
    const bool list = value.type() == Type::table && (option == nullptr || option->type != Option::Type::names);
    if (!list) {
      read_option(guide_, name, value, each_);
      return;
    }
    std::vector<Options::Entry> values;
    value.each([&](std::size_t, Value element) {
      std::vector<Options::Entry> one;
      read_option(guide_, name, element, one);
      values.push_back(one.front());
    });
    if (values.empty()) throw Error(fmt::format("schedule: option '{}' has an empty list of values", name));
    if (rounds_ != 0 && rounds_ != values.size()) {
      throw Error(fmt::format("schedule: option '{}' has {} values and '{}' has {}; each needs one for every round",
                              name, values.size(), lists_.front().first, rounds_));
    }
    rounds_ = values.size();
    lists_.emplace_back(name, std::move(values));
  }

  const Component& guide_;
  Value table_;
  std::size_t rounds_ = 0;
  std::vector<Options::Entry> own_;
  std::vector<Options::Entry> each_;
  std::vector<std::pair<std::string, std::vector<Options::Entry>>> lists_;
  std::optional<PlannerSpec> planner_;
};

int make_schedule(Stack& call, const ScriptPlace& place) {
  if (call.count() == 1 && call[1].type() == Type::table) {
    const Constructor* constructor = nullptr;
    call[1].each([&](std::size_t i, Value value) {
      if (i == 1) constructor = value.get<Constructor>();
    });
    if (constructor != nullptr && constructor->component->kind == Component::Kind::guide) {
      Origin origin;
      if (const auto position = call.where()) origin = {position->script, position->line};
      const Rounds rounds(*constructor->component, call[1]);
      const std::vector<GuideSpec> parts = rounds.guides(origin, place);
      check_size(parts.size());
      return call.result(schedule(parts, schedule_settings().read(rounds.options())));
    }
  }
  const Arguments arguments(schedule_construct(), call);
  return call.result(schedule(read_parts("schedule", arguments), schedule_settings().read(arguments.options())));
}

int make_split(Stack& call) {
  const Arguments arguments(split_construct(), call);
  const SplitSettings settings = split_settings().read(arguments.options());
  std::optional<PlannerSpec> planner;
  std::optional<StrategySpec> strategy;
  arguments.each([&](std::size_t i, Value value) {
    if (i > 1)
      throw Error(fmt::format("split: takes one planner or strategy, got {} as number {}", describe(value), i));
    if (value.get<GuideSpec>() != nullptr) {
      throw Error(
          fmt::format("split: a guide alone solves nothing; close it with a planner, as in split {{ {} >> rrt {{}} }}",
                      value.get<GuideSpec>()->text()));
    }
    if (const auto* given = value.get<PlannerSpec>()) planner = *given;
    strategy = as_strategy(value);
    if (!strategy) throw Error(fmt::format("split: takes a planner or a strategy, got {}", describe(value)));
  });
  if (!strategy) throw Error("split: takes a planner or a strategy, as split { rrt {}, depth = 2 }, got nothing");
  return planner ? call.result(split(*planner, settings)) : call.result(split(*strategy, settings));
}

}  // namespace

std::size_t components_of(const GuideSpec& guide) {
  std::size_t sum = 0;
  if (guide.kind() != GuideSpec::Kind::component) {
    for (const auto& term : guide.terms()) sum += components_of(term.guide);
    return sum;
  }
  return 1 + (guide.below() != nullptr ? components_of(*guide.below()) : 0);
}

void check_size(std::size_t components) {
  if (components <= most_components) return;
  throw Error(
      fmt::format("the composition would have {} components; at most {} are allowed", components, most_components));
}

std::vector<const Construct*> combinator_constructs() {
  return {&sequence_construct(), &blend_construct(), &schedule_construct(), &race_construct(), &split_construct()};
}

void open_combinators(Stack& stack, const ScriptPlace& place) {
  const std::array<std::pair<const Construct*, lua::Callback>, 5> all = {
      {{&sequence_construct(), make_sequence},
       {&blend_construct(), make_blend},
       {&schedule_construct(), [place](Stack& call) { return make_schedule(call, place); }},
       {&race_construct(), make_race},
       {&split_construct(), make_split}}};
  for (const auto& [construct, make] : all) {
    stack.push_function(make);
    stack.set_global(construct->name);
  }
}

}  // namespace trellis::dsl
