// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <dsl/language/tools/reference.hpp>
#include <dsl/language/tools/words.hpp>

namespace trellis::dsl {

namespace {

/// The package has functions of its own under these names, which are the words and more.
constexpr std::array<std::string_view, 2> own_names = {"experiment", "problem"};

bool is_own(const std::string& name) { return std::find(own_names.begin(), own_names.end(), name) != own_names.end(); }

/// Returns the parts of a type of LuaCATS that `separator` separates outside of brackets and quotes.
std::vector<std::string_view> parts_of(std::string_view type, char separator) {
  std::vector<std::string_view> parts;
  int depth = 0;
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < type.size(); ++i) {
    const char c = type[i];
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '(' || c == '{' || c == '<' || c == '[') ++depth;
    if (c == ')' || c == '}' || c == '>' || c == ']') --depth;
    if (c != separator || depth > 0) continue;
    parts.push_back(type.substr(begin, i - begin));
    begin = i + 1;
  }
  parts.push_back(type.substr(begin));
  return parts;
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// The type in Python for a type of LuaCATS without alternatives.
std::string python_part(std::string_view type, bool result);

/// The type in Python for a type of LuaCATS.
/// \param result  of what a word returns; else of what it takes
std::string python_type(std::string_view type, bool result) {
  if (parts_of(type, ',').size() > 1) return "Any";
  std::vector<std::string> all;
  for (const std::string_view part : parts_of(type, '|')) {
    std::string one = python_part(trimmed(part), result);
    if (one == "Any") return "Any";
    if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(std::move(one));
  }
  return all.size() == 1 ? all.front() : fmt::format("Union[{}]", fmt::join(all, ", "));
}

std::string python_part(std::string_view type, bool result) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 12> names = {{{"number", "float"},
                                                                                    {"integer", "int"},
                                                                                    {"string", "str"},
                                                                                    {"boolean", "bool"},
                                                                                    {"false", "bool"},
                                                                                    {"nil", "None"},
                                                                                    {"table", "Dict[str, Any]"},
                                                                                    {"trellis.Guide", "Guide"},
                                                                                    {"trellis.Planner", "Strategy"},
                                                                                    {"trellis.Strategy", "Strategy"},
                                                                                    {"trellis.Problem", "Problem"},
                                                                                    {"trellis.Experiment", "Script"}}};
  constexpr std::string_view list = "[]", mapping = "table<";
  if (type.ends_with(list)) {
    type.remove_suffix(list.size());
    return fmt::format("{}[{}]", result ? "List" : "Sequence", python_type(type, result));
  }
  if (type.starts_with('(') && type.ends_with(')')) return python_type(type.substr(1, type.size() - 2), result);
  if (type.starts_with(mapping) && type.ends_with('>')) {
    const auto inside = parts_of(type.substr(mapping.size(), type.size() - mapping.size() - 1), ',');
    if (inside.size() != 2) return "Any";
    return fmt::format("{}[{}, {}]", result ? "Dict" : "Mapping", python_type(trimmed(inside[0]), result),
                       python_type(trimmed(inside[1]), result));
  }
  const auto* const name =
      std::find_if(names.begin(), names.end(), [&](const auto& entry) { return entry.first == type; });
  if (name != names.end()) return std::string(name->second);
  if (type.starts_with('"')) return fmt::format("Literal[{}]", type);
  const bool object = type.starts_with("trellis.") && type.find_first_of("<({ ") == std::string_view::npos;
  return object ? "Value" : "Any";
}

std::string python_type(const Option& option) {
  switch (option.type) {
    case Option::Type::number: return "float";
    case Option::Type::integer: return "int";
    case Option::Type::boolean: return "bool";
    case Option::Type::choice: {
      std::string all;
      for (const auto& choice : option.choices) all += fmt::format("{}\"{}\"", all.empty() ? "" : ", ", choice);
      return fmt::format("Literal[{}]", all);
    }
    case Option::Type::names: return "Sequence[str]";
    case Option::Type::file: return "str";
  }
  throw Fault("unknown type of option");
}

std::string python_default(const OptionValue& value) {
  if (const auto* boolean = std::get_if<bool>(&value)) return *boolean ? "True" : "False";
  if (const auto* number = std::get_if<double>(&value); number != nullptr && std::isinf(*number)) {
    return *number > 0.0 ? "math.inf" : "-math.inf";
  }
  if (const auto* names = std::get_if<std::vector<std::string>>(&value)) {
    std::string all;
    for (const std::string& name : *names)
      all += fmt::format("{}{}", all.empty() ? "" : ", ", to_string(OptionValue(name)));
    return fmt::format("[{}]", all);
  }
  return to_string(value);
}

/// The default of a field where it is a number, a text, or true or false; else an ellipsis.
std::string python_default(const Field& field) {
  const std::string& text = field.default_text;
  if (text == "true" || text == "false") return text == "true" ? "True" : "False";
  const bool number = !text.empty() && text.find_first_not_of("0123456789.") == std::string::npos;
  const bool quoted = text.size() > 1 && text.starts_with('"') && text.find('"', 1) == text.size() - 1;
  return number || quoted ? text : "...";
}

std::string parameter(const Option& option) {
  return fmt::format("{}: {} = {}", option.name, python_type(option), python_default(option.default_value));
}

std::string parameter(const Field& field) {
  const std::string type = python_type(field.type, false);
  return field.required ? fmt::format("{}: {}", field.name, type)
                        : fmt::format("{}: {} = {}", field.name, type, python_default(field));
}

/// Lines of a docstring, indented.
std::string docstring(std::string_view text, const std::string& indent) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\' || c == '"') escaped += '\\';
    escaped += c;
  }
  while (escaped.ends_with('\n')) escaped.pop_back();
  return fmt::format("{}\"\"\"{}\"\"\"\n", indent, escaped);
}

std::string function(const Word& word, const std::string& indent) {
  const std::string name = word.module().empty() ? word.name : word.name.substr(word.module().size() + 1);
  return fmt::format("{0}def {1}{2}:\n{3}", indent, name, python_signature(word),
                     docstring(word.summary, indent + "    "));
}

}  // namespace

std::string python_signature(const Word& word) {
  std::vector<std::string> parameters;
  std::vector<std::string> taken;
  bool rest = false;
  for (const Field& argument : word.arguments) parameters.push_back(parameter(argument));
  for (const std::string& name : word.positional) {
    const auto option =
        std::find_if(word.options.begin(), word.options.end(), [&](const Option& o) { return o.name == name; });
    if (option == word.options.end()) throw Fault("a positional option that is none: " + name);
    taken.push_back(name);
    rest = option->type == Option::Type::names;
    parameters.push_back(rest ? fmt::format("*{}: str", name) : parameter(*option));
  }
  if (!word.element.empty()) {
    parameters.push_back(fmt::format("*elements: {}", python_type(word.element, false)));
    rest = true;
  }
  std::vector<std::string> named;
  for (const Field& field : word.fields) {
    if (field.required) named.push_back(parameter(field));
  }
  for (const Field& field : word.fields) {
    if (!field.required) named.push_back(parameter(field));
  }
  for (const Option& option : word.options) {
    if (std::find(taken.begin(), taken.end(), option.name) == taken.end()) named.push_back(parameter(option));
  }
  if (!named.empty() && !rest) parameters.emplace_back("*");
  parameters.insert(parameters.end(), named.begin(), named.end());
  return fmt::format("({}) -> {}", fmt::join(parameters, ", "),
                     word.returns.empty() ? "Any" : python_type(word.returns, true));
}

std::string reference_python() {
  std::string text =
      "# SPDX-License-Identifier: MIT-0\n# Generated by scripts/reference; do not edit.\n"
      "\"\"\"Every word of the language as a function in Python.\"\"\"\nimport math\n"
      "from typing import Any, Dict, List, Literal, Mapping, Sequence, Union\n\n"
      "from ._trellis import Guide, Problem, Script, Strategy, Value\n\n";
  std::vector<std::string> modules;
  std::vector<std::string> all;
  for (const Word& word : words()) {
    const std::string module = word.module();
    if (!module.empty() && std::find(modules.begin(), modules.end(), module) == modules.end())
      modules.push_back(module);
    if (module.empty() && word.kind != Word::Kind::module && !is_own(word.name)) all.push_back(word.name);
  }
  all.insert(all.end(), modules.begin(), modules.end());
  text += "__all__ = [\n";
  for (const std::string& name : all) text += fmt::format("    \"{}\",\n", name);
  text += "]\n\n";
  for (const Word& word : words()) {
    if (word.module().empty() && word.kind != Word::Kind::module && !is_own(word.name))
      text += function(word, "") + '\n';
  }
  for (const std::string& name : modules) {
    const auto module = std::find_if(words().begin(), words().end(), [&](const Word& word) {
      return word.kind == Word::Kind::module && word.name == name;
    });
    text += fmt::format(
        "class _{}:\n{}\n", name,
        docstring(module != words().end() ? module->summary : fmt::format("What makes a {}.", name), "    "));
    for (const Word& word : words()) {
      if (word.module() == name) text += "    @staticmethod\n" + function(word, "    ") + '\n';
    }
    text += fmt::format("{0}: _{0}\n\n", name);
  }
  text.resize(text.find_last_not_of('\n') + 2);
  return text;
}

}  // namespace trellis::dsl
