// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/tools/help_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/tools/words.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

/// Returns the word of a function or table: box, scenes.trap, robot; "" if it is not part of the language.
std::string word_of(Stack& call, Value value) {
  const int before = call.size();
  const Value globals = call.push_globals();
  const Value modules = call.push_hidden("modules");
  std::string found;
  const auto compare = [&](const std::string& name, Value candidate) {
    if (found.empty() && candidate.identity() == value.identity()) found = name;
  };
  for (const Word& word : words()) {
    const int kept = call.size();
    const std::string module = word.module();
    if (module.empty()) {
      compare(word.name, word.kind == Word::Kind::module ? modules.field(word.name) : globals.field(word.name));
    } else {
      const Value loaded = modules.field(module);
      const Value table = loaded.type() == Type::table ? loaded : globals.field(module);
      if (table.type() == Type::table) {
        compare(module, table);
        compare(word.name, table.field(word.name.substr(module.size() + 1)));
      }
    }
    call.resize(kept);
  }
  call.resize(before);
  return found;
}

/// Returns the members of a value's type; "" where it has none.
std::string members_of(Value value, std::size_t width) {
  std::string described = value.describe();  // "a robot"
  described.erase(0, described.find(' ') + 1);
  if (described.empty()) return "";
  described.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(described.front())));
  const std::string name = "trellis." + described;
  const auto& types = object_types();
  const bool known = std::any_of(types.begin(), types.end(),
                                 [&](const ObjectType& type) { return type.name == name && !type.members.empty(); });
  return known ? help_text(name, width) : "";
}

}  // namespace

std::string help_text_of(Stack& call, Value value, std::size_t width) {
  if (const auto word = value.string()) return help_text(*word, width);
  if (const auto* constructor = value.get<Constructor>()) return help_text(constructor->component->name, width);
  if (const auto strategy = as_strategy(value)) {
    std::string text = fmt::format("{}: {}\n\n{}", value.get<PlannerSpec>() != nullptr ? "planner" : "strategy",
                                   strategy->text(), strategy->tree());
    if (!text.ends_with('\n')) text += '\n';
    return text + '\n' + help_text(value.get<PlannerSpec>() != nullptr ? "trellis.Planner" : "trellis.Strategy", width);
  }
  if (const auto* guide = value.get<GuideSpec>()) {
    std::string text = fmt::format("guide: {}\n\n", guide->text());
    if (guide->kind() == GuideSpec::Kind::component) return text + help_text("guide." + guide->name(), width);
    return text + help_text("trellis.Guide", width);
  }
  if (value.type() == Type::function || value.type() == Type::table) {
    const std::string word = word_of(call, value);
    if (!word.empty()) return help_text(word, width);
  }
  if (value.type() == Type::object) {
    const std::string text = fmt::format("{}: {}\n", value.describe(), value.text());
    const std::string members = members_of(value, width);
    return members.empty() ? text : text + '\n' + members;
  }
  throw Error(fmt::format("help: nothing is known about {}; help() lists all words", describe(value)));
}

std::string help_of(Stack& call) { return call[1].given() ? help_text_of(call, call[1]) : vocabulary_text(); }

}  // namespace trellis::dsl
