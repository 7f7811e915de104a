// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/measure.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include <dsl/language/core/random.hpp>
#include <dsl/language/core/word.hpp>
#include <dsl/language/words/configuration.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

const Settings<TargetSettings>& user_settings() {
  constexpr Range count{.lo = 64, .hi = 1e7};
  static const auto settings =
      Settings<TargetSettings>(Component::Kind::target, "target", "a target of one's own", "")
          .number("delta", &TargetSettings::delta, "m", Range::positive(), "radius of the balls that coverage counts")
          .integer("points", &TargetSettings::points, "points", count, "evaluation points on the target")
          .integer("pool", &TargetSettings::pool, "points", count,
                   "points of the target for the volumes of cut balls and for `exact`, at least as many as points; all "
                   "are drawn");
  return settings;
}

// A user's target
// ------------------------------------------------------------------------------------------------------

/// The functions of one `target { ... }`, and its position in the script.
struct UserFunctions {
  std::string where;  ///< "script.lua:3: "
  lua::Reference sample;
  lua::Reference log_density;
  lua::Limits each;  ///< limits of one call
  std::shared_ptr<bool> called = std::make_shared<bool>(false);
};

/// Pushes the arguments of a target's functions: the path, the problem and its space, and functions to query them.
void push_context(Stack& stack, const UserTarget::Context& context) {
  const Space& space = context.problem.space;
  const Value table = stack.push_table();
  const Value path = stack.push_table();
  for (std::size_t i = 0; i < context.path.size(); ++i) {
    push_numbers(stack, context.path[i]);
    stack.append(path);
  }
  stack.set_field(table, "path");
  stack.push_object(context.problem);
  stack.set_field(table, "problem");
  push_space(stack, space);
  stack.set_field(table, "space");
  const auto source = std::make_shared<RandomSource>(Stream(context.seed, "", "target"));
  stack.push_function(random_function(source, "random"));
  stack.set_field(table, "random");
  stack.push_function(normal_function(source));
  stack.set_field(table, "normal");
  const std::shared_ptr<Instance> instance = make_instance(context.problem);
  stack.push_function([instance](Stack& call) {
    const Configuration q = read_configuration(call[1], instance->space, "valid: its argument");
    return call.result(instance->space.contains(q) && instance->validity->state(q));
  });
  stack.set_field(table, "valid");
}

/// Samples a user's target for one path, and computes its density there.
class UserDraws {
 public:
  UserDraws(std::shared_ptr<const UserFunctions> functions, const UserTarget::Context& context)
      : functions_(std::move(functions)),
        scored_(context.scored),
        space_(context.problem.space),
        problem_(context.problem.name),
        draws_(context.draws) {
    interpreter("sample")->run([&](Stack& stack) {
      push_context(stack, context);
      context_ = std::make_shared<lua::Reference>(stack, stack.top());
    });
  }

  [[nodiscard]] Configuration sample(std::int64_t draw) const {
    const std::string which = fmt::format("sample, draw {} of {}", draw, draws_);
    Configuration q;
    ask(which, [&](Stack& stack) {
      functions_->sample.push(stack);
      context_->push(stack);
      stack.call(1);
      if (stack.size() == 0) throw Error("it returned nothing, expected a configuration");
      q = read_configuration(stack[1], space_, "what it returns");
      bring_into(space_, q, "what it returns");
    });
    return q;
  }

  [[nodiscard]] double log_density(View q) const {
    double value = 0.0;
    ask(
        "log_density", q, [&] { return asked_at(q); }, value);
    return value;
  }

  /// Checks that the density at a draw is finite.
  void check_density(std::int64_t draw, View q) const {
    const auto which = [&] { return fmt::format("log_density at draw {} of {}, {}", draw, draws_, coordinates_of(q)); };
    double value = 0.0;
    ask("log_density", q, which, value);
    if (std::isfinite(value)) return;
    fail(which(), fmt::format("it returned {:g} where 'sample' draws, expected a finite number: the target has a "
                              "density wherever it is drawn from",
                              value));
  }

 private:
  [[nodiscard]] std::shared_ptr<lua::State> interpreter(const char* function) const {
    auto interpreter = functions_->sample.interpreter();
    if (!interpreter) throw Fault(fmt::format("target: '{}' is asked after its interpreter is gone", function));
    return interpreter;
  }

  [[noreturn]] void fail(const std::string& which, const std::string& why) const {
    const std::string run = scored_ ? fmt::format(", strategy '{}', seed {}", scored_->strategy, scored_->seed) : "";
    throw lua::Located(fmt::format("{}target: {} (problem '{}'{}): {}", functions_->where, which, problem_, run, why));
  }

  /// "log_density at (1, 2), node 3 of 50 of lazy() >> rrt, level 1".
  [[nodiscard]] std::string asked_at(View q) const {
    std::string which = fmt::format("log_density at {}", coordinates_of(q));
    if (!scored_ || scored_->samples == nullptr) return which;
    const Configurations& samples = *scored_->samples;
    std::size_t i = 0;
    while (i < samples.size() && !std::equal(q.begin(), q.end(), samples[i].begin(), samples[i].end())) ++i;
    which += i < samples.size() ? fmt::format(", {} {} of {}", scored_->role, i + 1, samples.size())
                                : fmt::format(", for the {}s", scored_->role);
    return which + " of " + scored_->level;
  }

  void ask(const std::string& which, const std::function<void(Stack&)>& body) const {
    try {
      interpreter("sample")->run(body, functions_->each);
    } catch (const Error& error) {
      fail(which, error.what());
    }
  }

  /// Called often: builds a message only after an error.
  template <class Which>
  void ask(const char* function, View q, const Which& which, double& value) const {
    try {
      interpreter(function)->run(
          [&](Stack& stack) {
            functions_->log_density.push(stack);
            push_numbers(stack, q);
            context_->push(stack);
            stack.call(2);
            const auto number = stack.size() > 0 ? stack[1].number() : std::nullopt;
            if (!number || std::isnan(*number) || *number == std::numeric_limits<double>::infinity()) {
              throw Error(
                  fmt::format("it returned {}, expected the logarithm of a density, and -math.huge where there is "
                              "none",
                              stack.size() > 0 ? stack[1].describe() : "nothing"));
            }
            value = *number;
          },
          functions_->each);
    } catch (const Error& error) {
      fail(which(), error.what());
    }
  }

  std::shared_ptr<const UserFunctions> functions_;
  std::shared_ptr<const lua::Reference> context_;
  std::shared_ptr<const UserTarget::ScoredSamples> scored_;  // nullptr outside of an experiment
  Space space_;
  std::string problem_;
  std::int64_t draws_;
};

Target::Distribution distribution(const std::shared_ptr<const UserFunctions>& functions,
                                  const UserTarget::Context& context) {
  const auto draws = std::make_shared<const UserDraws>(functions, context);
  Target::Distribution made{Configurations(context.problem.space.dimension()),
                            [draws](View q) { return draws->log_density(q); }};
  made.samples.reserve(static_cast<std::size_t>(context.draws));
  for (std::int64_t i = 1; i <= context.draws; ++i) {
    const Configuration q = draws->sample(i);
    draws->check_density(i, q);
    made.samples.push(q);
  }
  return made;
}

int make_user_target(Stack& call, const lua::Limits& each, std::vector<Callback>& given) {
  const Arguments arguments(target_construct(), call);
  for (const char* name : {"sample", "log_density"}) {
    if (arguments[name].type() != Type::function) arguments.reject(name);
  }
  UserTarget target;
  static_cast<TargetSettings&>(target) = user_settings().read(arguments.options());
  const auto position = call.where();
  const std::shared_ptr<const UserFunctions> functions(new UserFunctions{
      position ? position->prefix() : "", {call, arguments["sample"]}, {call, arguments["log_density"]}, each});
  target.make = [functions](const UserTarget::Context& context) {
    *functions->called = true;
    return distribution(functions, context);
  };
  given.push_back({functions->where, "'sample' and 'log_density' of this target",
                   [called = functions->called] { return *called; }});
  return call.result(TargetSpec(std::move(target)));
}

// Texts
// ----------------------------------------------------------------------------------------------------------------

/// Returns the options of a target, in any order.
std::pair<const Component*, std::vector<Options::Entry>> options_of(const TargetSpec& target) {
  const TargetSettings& common = common_settings(target);
  std::vector<Options::Entry> options = {{"delta", common.delta}, {"points", common.points}, {"pool", common.pool}};
  const Component* component = &user_settings().component();
  const auto own = [&](const Component& of, std::vector<Options::Entry> entries) {
    component = &of;
    options.insert(options.end(), entries.begin(), entries.end());
  };
  if (const auto* tube = std::get_if<TubeSettings>(&target)) {
    own(tube_settings().component(), {{"distance", to_string(tube->distance)}, {"support", to_string(tube->support)}});
  } else if (const auto* near = std::get_if<NearOptimalSettings>(&target)) {
    own(near_optimal_settings().component(), {{"epsilon", near->epsilon}, {"nodes", near->nodes}});
  } else if (const auto* progress = std::get_if<ProgressSettings>(&target)) {
    own(progress_settings().component(), {{"step", progress->step}, {"controls", progress->controls}});
  }
  return {component, std::move(options)};
}

template <class T>
int to_text(Stack& call) {
  const auto* value = call[1].get<T>();
  if (value == nullptr) return call.result(call[1].describe());
  if constexpr (std::same_as<T, EstimatorSpec>) {
    const std::string text = value->text();
    return call.result(text.ends_with('}') ? text : text + " {}");
  } else {
    return call.result(text_of(*value));
  }
}

int equal_estimators(Stack& call) {
  const auto* a = call[1].get<EstimatorSpec>();
  const auto* b = call[2].get<EstimatorSpec>();
  return call.result(a != nullptr && b != nullptr && *a == *b);
}

}  // namespace

std::vector<const Component*> target_components() {
  return {&tube_settings().component(), &near_optimal_settings().component(), &progress_settings().component()};
}

std::vector<const Component*> estimator_components() {
  std::vector<const Component*> components;
  for (const auto& kind : measure::estimator_kinds()) components.push_back(kind.component);
  return components;
}

const Construct& target_construct() {
  static const Construct construct = {
      .name = "target",
      .usage = "target { sample = function(context) ... end, log_density = function(q, context) ... end }",
      .summary = "a target of one's own: a distribution over the space of the strategy's root",
      .list = "",
      .element = "",
      .fields = {{"sample", "fun(context: trellis.TargetContext): number[]", "a function",
                  "called with a context, returns one configuration of the root's space, drawn from the target; it has "
                  "context.path (a list of configurations), context.problem, context.space (name, dimension, and the "
                  "lists names, lower, upper, weights, periodic), context.random() as math.random, context.normal(), "
                  "and context.valid(q)",
                  true},
                 {"log_density", "fun(q: number[], context: trellis.TargetContext): number", "a function",
                  "called with a configuration and the context, returns the logarithm of the target's density with "
                  "respect to volume in metric coordinates (each coordinate times its weight), -math.huge outside of "
                  "the support",
                  true}},
      .options = user_settings().component(),
      .returns = "trellis.Target"};
  return construct;
}

std::vector<ObjectType> measure_types() {
  std::vector<ObjectType> types;
  types.push_back({"trellis.Target", "what samples are measured against", "", {}, {}});
  types.push_back({"trellis.Estimator", "how a density is estimated from samples", "", {}, {}});
  types.push_back(space_type());
  types.push_back({"trellis.TargetContext", "the arguments of a target's functions", "", {}, {}});
  types.back().members = {{"path", "number[][]", "", "the configurations of the run's path, in order"},
                          {"problem", "trellis.Problem", "", "the problem that was solved"},
                          {"space", "trellis.Space", "", "the space of the strategy's root"},
                          {"random", "fun(m?: integer, n?: integer): number", "",
                           "as math.random, on a stream of the "
                           "target's own"},
                          {"normal", "fun(): number", "", "a standard normal number"},
                          {"valid", "fun(q: number[]): boolean", "", "whether a configuration is valid"}};
  return types;
}

int make_target(const Component& component, Stack& call) {
  const Options options = validated(component, read_options(component, call, 2, false).options);
  const auto made = [&](const auto& settings) { return call.result(TargetSpec(settings.read(options))); };
  if (&component == &tube_settings().component()) return made(tube_settings());
  if (&component == &near_optimal_settings().component()) return made(near_optimal_settings());
  if (&component == &progress_settings().component()) return made(progress_settings());
  throw Fault("unknown target " + component.name);
}

int make_estimator(const Component& component, Stack& call) {
  const std::vector<Options::Entry> given = read_options(component, call, 2, false).options;
  static_cast<void>(validated(component, given));
  return call.result(EstimatorSpec::make(component.name, given));
}

std::string text_of(const TargetSpec& target) {
  const auto [component, options] = options_of(target);
  std::string inside = std::holds_alternative<UserTarget>(target) ? "sample = function, log_density = function" : "";
  for (const Option& option : component->options) {
    const auto it =
        std::find_if(options.begin(), options.end(), [&](const auto& entry) { return entry.first == option.name; });
    if (it == options.end() || it->second == option.default_value) continue;
    inside += fmt::format("{}{} = {}", inside.empty() ? "" : ", ", option.name, to_string(it->second));
  }
  return inside.empty() ? component->name + " {}" : fmt::format("{} {{ {} }}", component->name, inside);
}

std::string text_of(const std::vector<EstimatorSpec>& estimators) {
  std::string text;
  for (const EstimatorSpec& estimator : estimators) text += (text.empty() ? "" : ", ") + estimator.text();
  return text;
}

void open_measure(Stack& stack, const lua::Limits& each, const std::shared_ptr<std::vector<Callback>>& given) {
  stack.declare<TargetSpec>({{"__tostring", to_text<TargetSpec>}});
  stack.declare<EstimatorSpec>({{"__tostring", to_text<EstimatorSpec>}, {"__eq", equal_estimators}});
  for (const auto& components : {target_components(), estimator_components()}) {
    for (const Component* component : components) {
      stack.push_object(Constructor{component});
      stack.set_global(component->name);
    }
  }
  stack.push_function([each, given](Stack& call) { return make_user_target(call, each, *given); });
  stack.set_global(target_construct().name);
}

}  // namespace trellis::dsl
