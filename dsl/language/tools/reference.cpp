// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/tools/reference.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include <dsl/language/tools/words.hpp>
#include <dsl/language/words/modules.hpp>
#include <trellis/planner/common.hpp>
#include <trellis/strategy/combinators.hpp>

namespace trellis::dsl {

namespace {

constexpr std::array<std::pair<Word::Kind, std::string_view>, 7> kinds = {{{Word::Kind::planner, "Planners"},
                                                                           {Word::Kind::guide, "Guides"},
                                                                           {Word::Kind::target, "Targets"},
                                                                           {Word::Kind::estimator, "Estimators"},
                                                                           {Word::Kind::constructor, "Constructors"},
                                                                           {Word::Kind::function, "Functions"},
                                                                           {Word::Kind::module, "Modules"}}};

bool has_table(const Word& word) { return !word.fields.empty() || !word.options.empty() || !word.element.empty(); }

bool is_required(const Field& field) { return field.required; }

/// Returns the tables of functions that are no module: those of words with a dot whose module is no word itself.
std::vector<std::string> tables() {
  std::vector<std::string> names;
  for (const Word& word : words()) {
    const std::string module = word.module();
    if (!module.empty() && std::find(names.begin(), names.end(), module) == names.end()) names.push_back(module);
  }
  return names;
}

// Markdown
// -------------------------------------------------------------------------------------------------------------

/// Text in a cell of a table.
std::string cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|' || c == '*' || c == '<') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string code(const std::string& text) { return text.empty() ? "" : fmt::format("`{}`", text); }

/// Capitalises the first letter, unless the text begins with a symbol.
std::string sentence(std::string_view text) {
  std::string all = cell(text);
  const bool symbol = all.size() > 1 && all[1] == ' ' && all[0] != 'a';
  if (!all.empty() && !symbol) all[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(all[0])));
  return all;
}

/// Returns the values of an option, without its unit.
std::string values_of(Option option) {
  option.unit.clear();
  return expectation(option);
}

std::string row(const Option& option) {
  return fmt::format("| `{}` | {} | {} | {} | {} |\n", option.name, cell(values_of(option)), cell(option.unit),
                     code(default_text(option)), cell(option.doc));
}

std::string row(const Field& field) {
  const bool plain = field.default_text.empty() || field.default_text.find(' ') == std::string::npos ||
                     field.default_text.find_first_of("({\"") != std::string::npos;
  return fmt::format("| `{}` | {} | | {} | {} |\n", field.name, cell(field.expects),
                     field.required ? "required"
                     : plain        ? code(field.default_text)
                                    : cell(field.default_text),
                     cell(field.doc));
}

template <class T>
std::string rows(const std::vector<T>& entries) {
  std::string text;
  for (const T& entry : entries) text += row(entry);
  return text;
}

std::string table(const std::string& title, const std::string& body) {
  if (body.empty()) return "";
  return fmt::format("| {} | Takes | Unit | Default | Meaning |\n|---|---|---|---|---|\n{}\n", title, body);
}

std::string link(const std::string& name) {
  std::string anchor;
  for (const char c : name) {
    if (c != '.') anchor += c;
  }
  return fmt::format("[`{}`](#{})", name, anchor);
}

/// The options that all planners have.
const std::vector<Option>& common_options() {
  static const auto settings = with_common(Settings<CommonSettings>(Component::Kind::planner, "planner", "", ""));
  return settings.component().options;
}

/// Returns the common option with the name and the meaning of an option; nullptr where there is none.
const Option* common_option(const Option& option) {
  for (const Option& common : common_options()) {
    if (common.name == option.name && common.doc == option.doc) return &common;
  }
  return nullptr;
}

constexpr std::string_view common_title = "Options of every planner";

std::string common_section() {
  return fmt::format("### {}\n\nThe default of `goal_bias` is that of `rrt`; planners with another say so.\n\n{}",
                     common_title, table("Option", rows(common_options())));
}

/// Returns the own options of a planner as a table, then a line on those of every planner.
std::string planner_options(const Word& word) {
  std::string own;
  std::string others;
  for (const Option& option : word.options) {
    const Option* const common = common_option(option);
    if (common == nullptr) {
      own += row(option);
    } else if (!(common->default_value == option.default_value)) {
      others += fmt::format("; `{}` is {} by default", option.name, code(default_text(option)));
    }
  }
  return table("Option", own) +
         fmt::format("And the [options of every planner](#options-of-every-planner){}.\n\n", others);
}

std::string section(const Word& word) {
  std::string text = fmt::format("### {}\n\n", word.name);
  std::string_view lines = word.text;
  if (word.kind == Word::Kind::module) {
    // The comment's examples are indented and separated from its prose.
    while (!lines.empty()) {
      const std::string_view line = lines.substr(0, lines.find('\n'));
      lines.remove_prefix(std::min(lines.size(), line.size() + 1));
      text += fmt::format("{}{}\n", line.starts_with("  ") ? "  " : "", line);
    }
    text += '\n';
    for (const Word& inside : words()) {
      if (inside.module() == word.name) text += fmt::format("- {}: {}\n", link(inside.name), inside.summary);
    }
    return text + '\n';
  }
  text += sentence(word.summary) + ".\n";
  if (!word.usage.empty()) text += fmt::format("\n    {}\n", word.usage);
  if (!word.positional.empty()) {
    text += fmt::format("\nWithout names: `{}({})`.\n", word.name, fmt::join(word.positional, ", "));
  }
  if (!word.list.empty()) text += fmt::format("\nElements: {}.\n", cell(word.list));
  if (!word.source.empty()) text += fmt::format("\nSource: {}.\n", cell(word.source));
  text += '\n';
  text += table("Argument", rows(word.arguments));
  if (word.kind == Word::Kind::planner) return text + planner_options(word);
  const bool component = word.kind < Word::Kind::constructor;
  text += table("Option", component ? rows(word.options) + rows(word.fields) : rows(word.fields) + rows(word.options));
  return text;
}

std::string section(const ObjectType& type) {
  std::string text = fmt::format("### {}\n\n{}.\n\n", type.name, sentence(type.summary));
  if (!type.parent.empty())
    text += fmt::format("Whatever can be done with a `{}` can be done with it.\n\n", type.parent);
  if (!type.operations.empty()) text += "| Operation | Makes |\n|---|---|\n";
  for (const Operation& o : type.operations) {
    text += fmt::format("| `{} {} {}` | `{}` |\n", type.name, o.symbol, o.operand, o.result);
  }
  if (!type.operations.empty()) text += '\n';
  if (!type.members.empty()) text += "| Member | Type | Meaning |\n|---|---|---|\n";
  for (const Field& member : type.members) {
    const bool method = member.type.starts_with("fun(self");
    text += fmt::format("| `{}{}` | {} | {} |\n", member.name, method ? "()" : "",
                        code(method ? member.type.substr(member.type.find("): ") + 3) : member.type), cell(member.doc));
  }
  if (!type.members.empty()) text += '\n';
  return text;
}

// Stubs
// -------------------------------------------------------------------------------------------------------------

/// Every line of the text as a comment of LuaCATS.
std::string comment(std::string_view text) {
  std::string lines;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    lines += fmt::format("---{}\n", line);
  }
  return lines;
}

std::string stub_type(const Option& option) {
  switch (option.type) {
    case Option::Type::number: return "number";
    case Option::Type::integer: return "integer";
    case Option::Type::boolean: return "boolean";
    case Option::Type::choice: {
      std::string all;
      for (const auto& choice : option.choices) all += fmt::format("{}\"{}\"", all.empty() ? "" : "|", choice);
      return all;
    }
    case Option::Type::names: return "string[]";
    case Option::Type::file: return "string";
  }
  throw Fault("unknown type of option");
}

std::string stub_field(const Option& option) {
  return fmt::format("---@field {}? {} {}; default {}: {}\n", option.name, stub_type(option), expectation(option),
                     default_text(option), option.doc);
}

std::string stub_field(const Field& field) {
  std::string text = field.expects;
  if (!field.default_text.empty()) text += (text.empty() ? "default " : "; default ") + field.default_text;
  if (!field.doc.empty()) text += (text.empty() ? "" : ": ") + field.doc;
  return fmt::format("---@field {}{} {} {}\n", field.name, field.required ? "" : "?", field.type, text);
}

std::string options_class(const Word& word) { return fmt::format("trellis.{}.Options", word.name); }

std::string stub_options(const Word& word) {
  std::string text = fmt::format("---What `{}` takes.\n---@class {}\n", word.name, options_class(word));
  for (std::size_t i = 0; i < word.positional.size(); ++i) {
    const auto option = std::find_if(word.options.begin(), word.options.end(),
                                     [&](const Option& o) { return o.name == word.positional[i]; });
    if (option->type == Option::Type::names) {
      text += fmt::format("---@field [integer] string `{}` without its name\n", option->name);
      continue;
    }
    text += fmt::format("---@field [{}]? {} `{}` without its name\n", i + 1, stub_type(*option), option->name);
  }
  if (!word.element.empty()) text += fmt::format("---@field [integer] {} {}\n", word.element, word.list);
  for (const Field& field : word.fields) text += stub_field(field);
  for (const Option& option : word.options) text += stub_field(option);
  return text + '\n';
}

std::string stub_function(const Word& word) {
  std::string text = comment(word.summary);
  if (!word.usage.empty()) text += fmt::format("---\n---    {}\n", word.usage);
  if (!word.source.empty()) text += fmt::format("---\n---Source: {}\n", word.source);
  std::string parameters;
  for (const Field& argument : word.arguments) {
    text += fmt::format("---@param {}{} {} {}: {}\n", argument.name, argument.required ? "" : "?", argument.type,
                        argument.expects, argument.doc);
    parameters += (parameters.empty() ? "" : ", ") + argument.name;
  }
  if (has_table(word)) {
    const bool must = !word.element.empty() || std::any_of(word.fields.begin(), word.fields.end(), is_required);
    text += fmt::format("---@param options{} {}\n", must ? "" : "?", options_class(word));
    parameters += parameters.empty() ? "options" : ", options";
  }
  const std::string result = word.returns.empty() ? "" : ": " + word.returns;
  if (!word.returns.empty()) text += fmt::format("---@return {}\n", word.returns);
  if (!word.positional.empty()) {
    std::string unnamed;
    std::string rest = fmt::format("options?: {}", options_class(word));
    for (const auto& name : word.positional) {
      const auto option =
          std::find_if(word.options.begin(), word.options.end(), [&](const Option& o) { return o.name == name; });
      if (option->type == Option::Type::names) {
        rest = "...: string";  // takes the remaining arguments
      } else {
        unnamed += fmt::format("{}: {}, ", name, stub_type(*option));
      }
    }
    text += fmt::format("---@overload fun({}{}){}\n", unnamed, rest, result);
  }
  if (!word.element.empty()) text += fmt::format("---@overload fun(...: {}){}\n", word.element, result);
  return text + fmt::format("function {}({}) end\n\n", word.name, parameters);
}

std::string stub_class(const ObjectType& type) {
  std::string text = comment(type.summary);
  text += fmt::format("---@class {}{}\n", type.name, type.parent.empty() ? "" : ": " + type.parent);
  for (const Operation& o : type.operations) {
    text += fmt::format("---@operator {}({}): {}\n", o.event, o.operand, o.result);
  }
  for (const Field& member : type.members) {
    text += fmt::format("---@field {} {} {}\n", member.name, member.type, member.doc);
  }
  return text + '\n';
}

}  // namespace

std::string reference_markdown() {
  std::string text =
      "<!-- SPDX-License-Identifier: GPL-3.0-or-later -->\n<!-- Generated by scripts/reference; do not edit. -->\n"
      "# Reference\n\nEvery word of the language, as `trellis help WORD` explains it. Lengths are in metres, angles in "
      "radians, times in\nseconds. All options have a default; what is required says so.\n\n";
  for (const auto& [kind, title] : kinds) {
    text += fmt::format("**{}:** ", title);
    std::string list;
    for (const Word& word : words()) {
      if (word.kind == kind) list += (list.empty() ? "" : ", ") + link(word.name);
    }
    text += list + "\n\n";
  }
  text += "## Composition\n\n| | |\n|---|---|\n";
  for (const Combinator& combinator : combinators()) {
    text += fmt::format("| `{}` | {} |\n", combinator.written, combinator.summary);
  }
  text += '\n';
  for (const auto& [kind, title] : kinds) {
    text += fmt::format("## {}\n\n", title);
    if (kind == Word::Kind::planner) text += common_section();
    for (const Word& word : words()) {
      if (word.kind == kind) text += section(word);
    }
  }
  text += "## Types\n\nWhat scripts hold, under the names that stubs give them.\n\n";
  for (const ObjectType& type : object_types()) text += section(type);
  text.resize(text.find_last_not_of('\n') + 2);
  return text;
}

std::string reference_stubs() {
  std::string text =
      "---@meta\n-- SPDX-License-Identifier: MIT-0\n-- Printed by trellis reference stubs. "
      "lua-language-server reads it where its setting\n-- workspace.library names the folder that it lies in.\n"
      "-- luacheck: ignore\n\n";
  for (const ObjectType& type : object_types()) text += stub_class(type);
  for (const Word& word : words()) {
    if (has_table(word)) text += stub_options(word);
  }
  for (const auto& name : tables()) {
    const auto module = std::find_if(words().begin(), words().end(), [&](const Word& word) {
      return word.kind == Word::Kind::module && word.name == name;
    });
    text += module != words().end() ? comment(module->text) : fmt::format("---What makes a {}.\n", name);
    text += fmt::format("---@class trellis.{}\n{} = {{}}\n\n", name, name);
  }
  for (const Word& word : words()) {
    if (word.kind != Word::Kind::module) text += stub_function(word);
  }
  text.resize(text.find_last_not_of('\n') + 2);
  return text;
}

std::string reference_luacheck() {
  std::string text =
      "-- SPDX-License-Identifier: GPL-3.0-or-later\n-- Generated by scripts/reference; do not edit.\n"
      "-- What a Trellis script finds besides Lua, and what it does not find.\nstds.trellis = {\n  read_globals = {\n";
  constexpr std::size_t width = 110;
  const auto list = [&](const std::vector<std::string>& names, const std::string& indent) {
    std::string line = indent;
    for (const auto& name : names) {
      const std::string entry = fmt::format("\"{}\",", name);
      if (line.size() + entry.size() > width) text += std::exchange(line, indent) + '\n';
      line += (line == indent ? "" : " ") + entry;
    }
    if (line != indent) text += line + '\n';
  };
  for (const auto& [kind, title] : kinds) {
    std::vector<std::string> names;
    for (const Word& word : words()) {
      const bool own = std::find(lua_names().begin(), lua_names().end(), word.name) != lua_names().end();
      if (word.kind == kind && kind != Word::Kind::module && word.module().empty() && !own) names.push_back(word.name);
    }
    list(names, "    ");
  }
  for (const auto& table : tables()) {
    text += fmt::format("    {} = {{\n      fields = {{\n", table);
    std::vector<std::string> names;
    for (const Word& word : words()) {
      if (word.module() == table) names.push_back(word.name.substr(table.size() + 1));
    }
    list(names, "        ");
    text += "      },\n    },\n";
  }
  text += "  },\n}\nstd = \"lua54+trellis\"\nnot_globals = {";
  for (const auto& name : left_out_names()) text += fmt::format("{}\"{}\"", text.ends_with('{') ? " " : ", ", name);
  return text + " }\n";
}

}  // namespace trellis::dsl
