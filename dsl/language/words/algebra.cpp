// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/algebra.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/core/word.hpp>
#include <dsl/language/words/combine.hpp>
#include <dsl/language/words/measure.hpp>
#include <trellis/strategy/registry.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Value;

std::size_t ends_of(const GuideSpec& guide);

std::size_t ends_over_terms(const GuideSpec& guide) {
  std::size_t sum = 0;
  for (const auto& term : guide.terms()) sum += ends_of(term.guide);
  return sum;
}

/// Returns the number of components without a guide: composition copies a new guide to each of them.
std::size_t ends_of(const GuideSpec& guide) {
  if (guide.kind() != GuideSpec::Kind::component) return ends_over_terms(guide);
  return guide.below() != nullptr ? ends_of(*guide.below()) : 1;
}

/// Throws if an operand is a constructor without a call: a frequent mistake that messages about types would hide.
void check_called(const char* symbol, Value a, Value b) {
  for (const Value& operand : {a, b}) {
    if (const auto* constructor = operand.get<Constructor>()) {
      throw Error(fmt::format("'{}': '{}' is a constructor: call it, as in {}()", symbol, constructor->component->name,
                              constructor->component->name));
    }
  }
}

[[noreturn]] void reject(const char* symbol, Value a, Value b, const std::string& why) {
  throw Error(fmt::format("'{}' cannot compose {} and {}: {}", symbol, describe(a), describe(b), why));
}

/// Adds the parts of mixtures that have no search of their own to guide. (A part of another combination could not stand
/// outside of it.)
void find_unguided(const GuideSpec& guide, std::vector<std::string>& parts) {
  if (guide.kind() == GuideSpec::Kind::component) {
    if (guide.below() != nullptr) find_unguided(*guide.below(), parts);
    return;
  }
  for (const auto& term : guide.terms()) {
    if (term.guide.searches()) {
      find_unguided(term.guide, parts);
    } else if (guide.kind() == GuideSpec::Kind::mixture) {
      parts.push_back(term.guide.text());
    }
  }
}

/// Warns of parts that the guide above does not guide.
void warn_of_unguided(const Stack& call, const GuideSpec& above, const GuideSpec& guided,
                      std::vector<std::string>& warnings) {
  if (!guided.searches()) return;  // an error
  std::vector<std::string> parts;
  find_unguided(guided, parts);
  if (parts.empty()) return;
  const auto position = call.where();
  std::string warning = fmt::format(
      "{0}'{1}' does not guide {2}: it searches no space (S = {{0}}) and stays unguided; where that is meant, write "
      "({1} >> ...) + {2}",
      position ? position->prefix() : "", above.text(), fmt::join(parts, " + "));
  if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(std::move(warning));
}

int nest(Stack& call, std::vector<std::string>& warnings) {
  const Value a = call[1], b = call[2];
  check_called(">>", a, b);
  const auto* above = a.get<GuideSpec>();
  if (above == nullptr) {
    if (a.get<PlannerSpec>() != nullptr) {
      reject(">>", a, b, "a planner cannot guide; it ends a strategy, so write guide >> planner");
    }
    if (a.get<StrategySpec>() != nullptr) {
      reject(">>", a, b, "a strategy is closed by its planner and cannot guide; put guides in front of the planner");
    }
    reject(">>", a, b, "the left side must be a guide");
  }
  if (const auto* guided = b.get<GuideSpec>()) {
    check_size(components_of(*guided) + ends_of(*guided) * components_of(*above));
    warn_of_unguided(call, *above, *guided, warnings);
    return call.result(*above >> *guided);
  }
  const auto strategy = as_strategy(b);
  if (!strategy) reject(">>", a, b, "the right side must be a guide, a planner or a strategy");
  if (const auto* guided = strategy->guide()) {
    check_size(components_of(*guided) + ends_of(*guided) * components_of(*above));
    warn_of_unguided(call, *above, *guided, warnings);
  }
  return call.result(*above >> *strategy);
}

/// Returns why `+` and `..` reject an operand that is no guide.
std::string guides_only(const char* symbol, Value a, Value b) {
  const auto planner = [](Value v) { return v.get<PlannerSpec>() != nullptr; };
  const auto strategy = [](Value v) { return v.get<StrategySpec>() != nullptr; };
  if (planner(a) || planner(b)) {
    return fmt::format("a planner is no guide; compose the guides first: (a {} b) >> planner", symbol);
  }
  if (strategy(a) || strategy(b)) {
    return fmt::format("a strategy is closed by its planner; compose the guides first: (a {} b) >> planner", symbol);
  }
  return "both sides must be guides";
}

int mix(Stack& call) {
  const Value a = call[1], b = call[2];
  check_called("+", a, b);
  const auto* left = a.get<GuideSpec>();
  const auto* right = b.get<GuideSpec>();
  if (left == nullptr || right == nullptr) {
    const bool number = a.number().has_value() || b.number().has_value();
    reject("+", a, b, guides_only("+", a, b) + (number ? "; a weight is written 0.5 * guide" : ""));
  }
  check_size(components_of(*left) + components_of(*right));
  return call.result(*left + *right);
}

int weigh(Stack& call) {
  Value number = call[1], guide = call[2];
  check_called("*", number, guide);
  if (guide.number()) std::swap(number, guide);
  if (!number.number() || guide.get<GuideSpec>() == nullptr) {
    reject("*", call[1], call[2], "it weights a guide by a number, as in 0.5 * guide");
  }
  return call.result(*number.number() * *guide.get<GuideSpec>());
}

int follow(Stack& call) {
  const Value a = call[1], b = call[2];
  check_called("..", a, b);
  const auto* left = a.get<GuideSpec>();
  const auto* right = b.get<GuideSpec>();
  if (left == nullptr || right == nullptr) {
    const bool text = a.string().has_value() || b.string().has_value();
    reject("..", a, b, guides_only("..", a, b) + (text ? "; tostring(guide) gives its text" : ""));
  }
  check_size(components_of(*left) + components_of(*right));
  return call.result(sequence({*left, *right}));
}

template <class T>
int equal(Stack& call) {
  const auto* a = call[1].get<T>();
  const auto* b = call[2].get<T>();
  return call.result(a != nullptr && b != nullptr && *a == *b);
}

template <>
int equal<StrategySpec>(Stack& call) {
  const auto* left = call[1].get<PlannerSpec>();
  const auto* right = call[2].get<PlannerSpec>();
  if (left != nullptr && right != nullptr) return call.result(*left == *right);
  // A planner is also a strategy.
  const auto a = as_strategy(call[1]);
  const auto b = as_strategy(call[2]);
  return call.result(a && b && *a == *b);
}

template <class T>
int to_text(Stack& call) {
  const auto* spec = call[1].get<T>();
  return call.result(spec != nullptr ? spec->text() : call[1].describe());
}

int constructor_text(Stack& call) {
  const auto* constructor = call[1].get<Constructor>();
  if (constructor == nullptr) return call.result(call[1].describe());
  const auto& [kind, name, summary, source, options, positional] = *constructor->component;
  return call.result(fmt::format("{}: {}, {}", name, to_string(kind), summary));
}

int construct(Stack& call, const ScriptPlace& place) {
  const auto* constructor = call[1].get<Constructor>();
  if (constructor == nullptr) throw Error("not a constructor");
  const Component& component = *constructor->component;
  if (component.kind == Component::Kind::target) return make_target(component, call);
  if (component.kind == Component::Kind::estimator) return make_estimator(component, call);
  Origin origin;
  if (const auto position = call.where()) origin = {position->script, position->line};
  if (component.kind == Component::Kind::planner) {
    Given given = read_options(component, call, 2, false);
    static_cast<void>(validated(component, given.options));
    place_files(component, given.options, place);
    return call.result(PlannerSpec::make(component.name, given.options, origin));
  }
  Given given = read_options(component, call, 2, true);
  static_cast<void>(validated(component, given.options));
  place_files(component, given.options, place);
  return call.result(GuideSpec::make(component.name, given.options, std::move(given.planner), origin));
}

const std::vector<Field>& strategy_methods() {
  static const std::vector<Field> methods = {
      {"tree", "fun(self: trellis.Strategy): string", "", "the hierarchy as a tree of text, a line for each level"},
      {"json", "fun(self: trellis.Strategy): string", "", "the hierarchy as JSON, with every option"},
      {"hash", "fun(self: trellis.Strategy): string", "", "16 hexadecimal digits, equal for equal strategies"}};
  return methods;
}

/// Reads a property of an executable spec.
int inspect(Stack& call) {
  std::vector<std::string> known;
  for (const Field& method : strategy_methods()) known.push_back(method.name);
  const auto asked = call[2].string();
  const auto found = asked ? std::find(known.begin(), known.end(), *asked) : known.end();
  if (found == known.end()) {
    throw Error(fmt::format("{} has no field {}{}; it has: tree(), json(), hash()", describe(call[1]),
                            call[2].describe(), asked ? did_you_mean(*asked, known) : ""));
  }
  call.push_function([what = *found](Stack& method) {
    const auto strategy = as_strategy(method[1]);
    if (!strategy) throw Error(fmt::format("{} is called with a colon: strategy:{}()", what, what));
    if (what == "tree") return method.result(strategy->tree());
    if (what == "json") return method.result(strategy->json());
    return method.result(fmt::format("{:016x}", strategy->hash()));
  });
  return 1;
}

int no_fields(Stack& call) { throw Error(fmt::format("{} has no field {}", describe(call[1]), call[2].describe())); }

int immutable(Stack& call) {
  throw Error(fmt::format("{} cannot be changed: specs are values; write a new one", describe(call[1])));
}

/// Adds the operators without a meaning for specs, with messages that name the correct one.
void add_refusals(lua::Metamethods& metamethods) {
  constexpr std::array<std::pair<const char*, const char*>, 13> binary = {{{"__sub", "-"},
                                                                           {"__div", "/"},
                                                                           {"__mod", "%"},
                                                                           {"__pow", "^"},
                                                                           {"__idiv", "//"},
                                                                           {"__band", "&"},
                                                                           {"__bor", "|"},
                                                                           {"__bxor", "~"},
                                                                           {"__shl", "<<"},
                                                                           {"__lt", "<"},
                                                                           {"__le", "<="},
                                                                           {"__unm", "-"},
                                                                           {"__bnot", "~"}}};
  for (const auto& [event, symbol] : binary) {
    metamethods.emplace_back(
        event,
        [symbol = symbol,
         unary = std::string_view(event) == "__unm" || std::string_view(event) == "__bnot"](Stack& call) -> int {
          constexpr const char* offer = "guides compose with '>>', '+', '*' and '..'";
          check_called(symbol, call[1], call[2]);
          if (unary) throw Error(fmt::format("'{}' means nothing for {}: {}", symbol, describe(call[1]), offer));
          // Lua compares a > b as b < a. A planner stands last, so before a guide it was typed after it.
          const bool order = *symbol == '<' && std::string_view(symbol) != "<<";
          const bool swapped = order && call[1].get<GuideSpec>() == nullptr && call[2].get<GuideSpec>() != nullptr;
          const bool unknown = order && call[1].get<GuideSpec>() != nullptr && call[2].get<GuideSpec>() != nullptr;
          try {
            if (swapped) reject(std::string_view(symbol) == "<" ? ">" : ">=", call[2], call[1], offer);
            if (unknown) {
              reject(std::string_view(symbol) == "<" ? "<' or '>" : "<=' or '>=", call[1], call[2], offer);
            }
            reject(symbol, call[1], call[2], offer);
          } catch (const Error& error) {
            if (order) throw lua::EndingError(error.what());  // Lua makes the result a boolean
            throw;
          }
        });
  }
  metamethods.emplace_back(
      "__len", [](Stack& call) -> int { throw Error(fmt::format("'#' means nothing for {}", describe(call[1]))); });
  metamethods.emplace_back("__newindex", immutable);
}

using Warnings = std::shared_ptr<std::vector<std::string>>;

lua::Metamethods operators(lua::Callback text, const Warnings& warnings) {
  lua::Metamethods all = {{"__shr", [warnings](Stack& call) { return nest(call, *warnings); }},
                          {"__add", mix},
                          {"__mul", weigh},
                          {"__concat", follow},
                          {"__tostring", std::move(text)}};
  add_refusals(all);
  return all;
}

template <class T>
void declare_spec(Stack& stack, lua::Callback equality, lua::Callback index, const Warnings& warnings) {
  auto metamethods = operators(to_text<T>, warnings);
  metamethods.emplace_back("__eq", std::move(equality));
  metamethods.emplace_back("__index", std::move(index));
  metamethods.emplace_back("__call", [](Stack& call) -> int {
    throw Error(fmt::format("{} is made already and cannot be called", describe(call[1])));
  });
  stack.declare<T>(metamethods);
}

}  // namespace

std::vector<ObjectType> algebra_types() {
  const std::string guide = "trellis.Guide", planner = "trellis.Planner", strategy = "trellis.Strategy";
  std::vector<ObjectType> types;
  types.push_back({guide, "a guiding space with its heuristic, or a composition of guides", "", {}, {}});
  types.back().operations = {{"shr", ">>", guide, guide},       {"shr", ">>", planner, strategy},
                             {"shr", ">>", strategy, strategy}, {"add", "+", guide, guide},
                             {"mul", "*", "number", guide},     {"concat", "..", guide, guide}};
  types.push_back({strategy, "a hierarchy that can be executed: guides, closed by a planner", "", {}, {}});
  types.back().members = strategy_methods();
  types.push_back({planner, "a planner with its options; by itself a strategy that nothing guides", strategy, {}, {}});
  return types;
}

void open_algebra(Stack& stack, const ScriptPlace& place, const std::shared_ptr<std::vector<std::string>>& warnings) {
  declare_spec<PlannerSpec>(stack, equal<StrategySpec>, inspect, warnings);
  declare_spec<GuideSpec>(stack, equal<GuideSpec>, no_fields, warnings);
  declare_spec<StrategySpec>(stack, equal<StrategySpec>, inspect, warnings);
  auto constructor = operators(constructor_text, warnings);
  constructor.emplace_back("__call", [place](Stack& call) { return construct(call, place); });
  constructor.emplace_back("__index", no_fields);
  stack.declare<Constructor>(constructor);
  for (const Component* component : components()) {
    if (component->kind != Component::Kind::planner && component->kind != Component::Kind::guide) continue;
    stack.push_object(Constructor{component});
    stack.set_global(component->name);
  }
  open_combinators(stack, place);
}

}  // namespace trellis::dsl
