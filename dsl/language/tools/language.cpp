// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/tools/language.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include <dsl/language/core/random.hpp>
#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/words/algebra.hpp>
#include <dsl/language/words/combine.hpp>
#include <dsl/language/words/experiment.hpp>
#include <dsl/language/words/guiding_space.hpp>
#include <dsl/language/words/help.hpp>
#include <dsl/language/words/manipulator.hpp>
#include <dsl/language/words/measure.hpp>
#include <dsl/language/words/modules.hpp>
#include <dsl/language/words/motion.hpp>
#include <dsl/language/words/problem.hpp>
#include <dsl/language/words/scenario.hpp>
#include <dsl/language/words/spatial_world.hpp>
#include <dsl/language/words/tuning.hpp>
#include <dsl/language/words/world.hpp>
#include <trellis/base/error.hpp>
#include <trellis/strategy/registry.hpp>

namespace trellis::dsl {

namespace {

/// A planner that a program registered must not hide a word of the language.
void check_free(lua::Stack& stack, const Component& component) {
  const int before = stack.size();
  const bool lua = stack.push_global(component.name).given();
  stack.resize(before);
  const auto all = constructs();
  const auto modules = module_names();
  const bool word =
      std::any_of(all.begin(), all.end(), [&](const Construct* c) { return c->name == component.name; }) ||
      std::find(modules.begin(), modules.end(), component.name) != modules.end();
  if (!lua && !word) return;
  throw Error(fmt::format("register_planner: '{}' is a word of {} already; choose another name", component.name,
                          lua ? "Lua" : "the language"));
}

void check_components(lua::Stack& stack) {
  for (const Component* component : components()) {
    if (component->kind == Component::Kind::planner || component->kind == Component::Kind::guide) {
      check_free(stack, *component);
    }
  }
}

}  // namespace

// An instruction takes some 10 ns. The time limit applies to work that is slow in few instructions.
double seconds_for(std::uint64_t instructions) { return std::max(1.0, 6e-8 * static_cast<double>(instructions)); }

/// Returns the limits of one call of a script's function, if loading may spend `instructions`.
lua::Limits call_limits(std::uint64_t instructions) {
  constexpr std::uint64_t share = 10;
  const std::uint64_t each = std::max<std::uint64_t>(1, instructions / share);
  return {each, seconds_for(each), "it",
          fmt::format("; is there an infinite loop? --instructions {} would allow a call {}", 10 * instructions,
                      10 * each)};
}

void open_language(lua::Stack& stack, const std::string& folder, const SessionOptions& options, LanguageParts parts) {
  const std::shared_ptr<GuideBook> book = parts.book ? std::move(parts.book) : std::make_shared<GuideBook>();
  book->each = call_limits(options.instructions);
  const ScriptPlace place{folder, options.trust, options.watch};
  open_libraries(stack, options.trust);
  declare_failed_value(stack);
  book->random = open_random(stack, options.seed);
  check_components(stack);
  open_algebra(stack, place, book->warnings);
  open_world(stack);
  open_spatial_world(stack, place, book->warnings);
  open_manipulator(stack, place, book->warnings);
  open_motion(stack);
  open_problem(stack, book->warnings);
  open_measure(stack, book->each, book->given);
  open_guiding_space(stack, book);
  open_experiment(stack);
  open_tuning(stack);
  open_scenario(stack, place, options.scenarios);
  if (parts.help) open_help(stack, std::move(parts.help), options.print);
  open_modules(stack, place, book->warnings, {constructs(), std::move(parts.described)});
}

std::vector<const Construct*> constructs() {
  std::vector<const Construct*> all = combinator_constructs();
  for (const Construct* construct : guiding_space_constructs()) all.push_back(construct);
  for (const Construct* construct : world_constructs()) all.push_back(construct);
  for (const Construct* construct : spatial_world_constructs()) all.push_back(construct);
  for (const Construct* construct : manipulator_constructs()) all.push_back(construct);
  for (const Construct* construct : motion_constructs()) all.push_back(construct);
  all.insert(all.end(), {&problem_construct(), &load_construct(), &robot_file_construct(), &exists_construct(),
                         &target_construct(), &experiment_construct(), &tune_construct(), &help_construct(),
                         &require_construct()});
  for (const Construct* construct : scenario_constructs()) all.push_back(construct);
  return all;
}

}  // namespace trellis::dsl
