// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/tools/words.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <variant>

#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/tools/language.hpp>
#include <dsl/language/words/algebra.hpp>
#include <dsl/language/words/guiding_space.hpp>
#include <dsl/language/words/manipulator.hpp>
#include <dsl/language/words/measure.hpp>
#include <dsl/language/words/modules.hpp>
#include <dsl/language/words/problem.hpp>
#include <dsl/language/words/scenario.hpp>
#include <dsl/language/words/spatial_world.hpp>
#include <dsl/language/words/world.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/strategy/registry.hpp>

namespace trellis::dsl {

namespace {

Word::Kind kind_of(const Component& component) {
  switch (component.kind) {
    case Component::Kind::planner: return Word::Kind::planner;
    case Component::Kind::guide: return Word::Kind::guide;
    case Component::Kind::target: return Word::Kind::target;
    case Component::Kind::estimator: return Word::Kind::estimator;
    default: throw Fault("a component that is no word: " + component.name);
  }
}

std::string result_of(Word::Kind kind) {
  switch (kind) {
    case Word::Kind::planner: return "trellis.Planner";
    case Word::Kind::guide: return "trellis.Guide";
    case Word::Kind::target: return "trellis.Target";
    case Word::Kind::estimator: return "trellis.Estimator";
    default: return "";
  }
}

Word word_of(const Component& component) {
  Word word;
  word.kind = kind_of(component);
  word.name = component.name;
  word.summary = component.summary;
  word.source = component.source;
  word.options = component.options;
  word.positional = component.positional;
  word.returns = result_of(word.kind);
  if (component.kind != Component::Kind::guide) return word;
  const GuideSpec guide = GuideSpec::make(component.name, {});
  if (const auto& planner = guide.planner()) {
    word.fields = {
        {"planner", "trellis.Planner", "a planner", "searches the guide's own space", false, planner->text()}};
  }
  return word;
}

Word word_of(const Construct& construct) {
  Word word;
  const bool function = !construct.arguments.empty() || construct.name.find('.') != std::string::npos;
  const bool value = construct.name.starts_with("robot.") || construct.name.starts_with("motion.");
  word.kind = function && !value ? Word::Kind::function : Word::Kind::constructor;
  word.name = construct.name;
  word.summary = construct.summary;
  word.source = construct.source.empty() ? construct.options.source : construct.source;
  word.usage = construct.usage;
  word.list = construct.list;
  word.element = construct.element;
  word.arguments = construct.arguments;
  word.fields = construct.fields;
  word.options = construct.options.options;
  word.returns = construct.returns;
  return word;
}

/// Returns the comment at the beginning of a module, without its licence line.
std::string head_of(std::string_view module) {
  std::string head;
  while (module.starts_with("--")) {
    const std::string_view line = module.substr(0, module.find('\n'));
    module.remove_prefix(std::min(module.size(), line.size() + 1));
    if (line.find("SPDX-License-Identifier") != std::string_view::npos) continue;
    head += line.substr(line.starts_with("-- ") ? 3 : 2);
    head += '\n';
  }
  return head;
}

Word module_word(const std::string& name) {
  Word word;
  word.kind = Word::Kind::module;
  word.name = name;
  word.text = head_of(*module_text(name));
  word.summary = word.text.substr(0, word.text.find('\n'));
  if (word.summary.ends_with('.')) word.summary.pop_back();
  return word;
}

std::vector<Word> make_words() {
  std::vector<Word> all;
  for (const Component* component : components()) {
    if (component->kind == Component::Kind::planner || component->kind == Component::Kind::guide) {
      all.push_back(word_of(*component));
    }
  }
  for (const Component* component : target_components()) all.push_back(word_of(*component));
  for (const Component* component : estimator_components()) all.push_back(word_of(*component));
  for (const Construct* construct : constructs()) all.push_back(word_of(*construct));
  for (const Construct& function : module_functions()) {
    const bool described = std::any_of(all.begin(), all.end(), [&](const Word& w) { return w.name == function.name; });
    if (!described) all.push_back(word_of(function));
  }
  for (const auto& name : module_names()) all.push_back(module_word(name));
  std::stable_sort(all.begin(), all.end(), [](const Word& a, const Word& b) { return a.kind < b.kind; });
  const auto begin = std::find_if(all.begin(), all.end(), [](const Word& w) { return w.kind == Word::Kind::function; });
  const auto end = std::find_if(begin, all.end(), [](const Word& w) { return w.kind != Word::Kind::function; });
  std::stable_sort(begin, end, [](const Word& a, const Word& b) { return a.module() < b.module(); });
  return all;
}

std::vector<ObjectType> make_types() {
  std::vector<ObjectType> all = algebra_types();
  for (ObjectType& type : world_types()) all.push_back(std::move(type));
  for (ObjectType& type : spatial_world_types()) all.push_back(std::move(type));
  for (ObjectType& type : manipulator_types()) all.push_back(std::move(type));
  all.push_back({"trellis.Motion", "how what moves can be driven", "", {}, {}});
  all.push_back(problem_type());
  for (ObjectType& type : measure_types()) all.push_back(std::move(type));
  for (ObjectType& type : guiding_space_types()) all.push_back(std::move(type));
  all.push_back({"trellis.Experiment",
                 "what a script returns to be run",
                 "",
                 {{"strategies", "table<string, trellis.Strategy>", "", "its strategies by name"},
                  {"problems", "table<integer|string, trellis.Problem>", "", "its problems by number and by name"},
                  {"seeds", "integer[]", "", "its seeds"}},
                 {}});
  for (ObjectType& type : scenario_types()) all.push_back(std::move(type));
  return all;
}

std::vector<std::string> make_lua_names() {
  std::vector<std::string> names;
  constexpr std::size_t memory = std::size_t{16} << 20U;
  const auto interpreter = std::make_shared<lua::State>(lua::State::Options{.memory = memory});
  interpreter->run([&](lua::Stack& stack) {
    open_libraries(stack, false);
    const lua::Value globals = stack.push_globals();
    for (const auto& name : globals.keys().names) {
      names.push_back(name);
      const lua::Value value = globals.field(name);
      if (value.type() != lua::Type::table || name == "_G") continue;
      for (const auto& field : value.keys().names) names.push_back(fmt::format("{}.{}", name, field));
    }
  });
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::vector<Construct> module_functions() {
  std::vector<Construct> functions;
  constexpr std::size_t memory = std::size_t{64} << 20U;
  const auto interpreter = std::make_shared<lua::State>(lua::State::Options{.memory = memory});
  interpreter->run([&](lua::Stack& stack) {
    open_language(stack, "", {}, {.described = [&](const Construct& construct) { functions.push_back(construct); }});
    for (const auto& name : module_names()) {
      stack.push_global(require_construct().name);
      stack.push(name);
      stack.call(1);
      if (stack.top().type() != lua::Type::table) continue;
      for (const auto& field : stack.top().keys().names) {
        const std::string full = fmt::format("{}.{}", name, field);
        const bool described =
            std::any_of(functions.begin(), functions.end(), [&](const Construct& c) { return c.name == full; });
        if (!described) functions.push_back({full, full + "()", "", "", "", {}, {}, ""});
      }
    }
  });
  return functions;
}

const std::vector<Word>& words() {
  static const std::vector<Word> all = make_words();
  return all;
}

const std::vector<ObjectType>& object_types() {
  static const std::vector<ObjectType> all = make_types();
  return all;
}

const std::vector<std::string>& lua_names() {
  static const std::vector<std::string> all = make_lua_names();
  return all;
}

}  // namespace trellis::dsl
