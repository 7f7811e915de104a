// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/vocabulary.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

#include <dsl/language/catalogue.hpp>
#include <dsl/language/words.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/report/glossary.hpp>
#include <trellis/strategy/combinators.hpp>

namespace trellis::dsl {

namespace {

/// Returns the name, and beside it the text in lines of a page's width.
std::string row(std::string name, std::string_view text) {
  constexpr std::size_t column = 76;
  constexpr std::size_t names = 18;
  std::string rows;
  if (name.size() > names) rows += fmt::format("  {}\n", std::exchange(name, ""));
  do {
    std::size_t end = text.size();
    if (end > column) {
      end = text.rfind(' ', column);
      if (end == std::string_view::npos) end = std::min(text.find(' '), text.size());
    }
    rows += fmt::format("  {:<18} {}\n", name, text.substr(0, end));
    text.remove_prefix(std::min(text.size(), end + 1));
    name.clear();
  } while (!text.empty());
  return rows;
}

/// Returns the values of a field, with its meaning below.
std::string rows_of(const Field& field) {
  std::string text = field.expects;
  if (field.required) text += "; required";
  if (!field.default_text.empty()) text += "; default " + field.default_text;
  return row(field.name, text) + (field.doc.empty() ? "" : row("", field.doc));
}

std::string rows_of(const Option& option) {
  return row(option.name, fmt::format("{}; default {}", expectation(option), default_text(option))) +
         (option.doc.empty() ? "" : row("", option.doc));
}

template <class T>
std::string section(const char* title, const std::vector<T>& entries) {
  if (entries.empty()) return "";
  std::string text = fmt::format("\n{}:\n", title);
  for (const T& entry : entries) text += rows_of(entry);
  return text;
}

bool is_component(const Word& word) { return word.kind < Word::Kind::constructor; }

/// Returns the words of a table, without its name: of a module, or of the robots.
std::string contents(const std::string& module) {
  std::string text;
  for (const Word& word : words()) {
    if (word.module() != module) continue;
    text += row(word.name.substr(module.size() + 1), word.summary.empty() ? "not described" : word.summary);
  }
  return text;
}

std::string component_text(const Word& word) {
  std::string text = fmt::format("{} ({}): {}\n", word.name, word.kind_text(), word.summary);
  if (!word.source.empty()) text += fmt::format("source: {}\n", word.source);
  if (const GuideKind* guide = word.kind == Word::Kind::guide ? find_guide(word.name) : nullptr) {
    text += '\n';
    for (const auto& [title, line] : claim_lines(guide->claims)) text += row(title, line);
  }
  std::string options;
  for (const Option& option : word.options) options += rows_of(option);
  for (const Field& field : word.fields) options += rows_of(field);
  text += options.empty() ? "\nno options\n" : "\noptions:\n" + options;
  if (!word.positional.empty()) {
    text += fmt::format("\nwithout names: {}({})\n", word.name, fmt::join(word.positional, ", "));
  }
  return text;
}

std::string construct_text(const Word& word) {
  std::string text = fmt::format("{}: {}\n", word.name, word.summary.empty() ? "not described" : word.summary);
  if (!word.source.empty()) text += fmt::format("source: {}\n", word.source);
  text += fmt::format("\n  {}\n", word.usage);
  if (!word.list.empty()) text += fmt::format("\nelements: {}\n", word.list);
  text += section("arguments", word.arguments);
  text += section("fields", word.fields);
  text += section("options", word.options);
  return text;
}

std::string text_of(const Word& word) {
  if (word.kind == Word::Kind::module) {
    const std::string inside = contents(word.name);
    return word.text + (inside.empty() ? "" : fmt::format("\nin {}:\n{}", word.name, inside));
  }
  return is_component(word) ? component_text(word) : construct_text(word);
}

/// "strategy" of "trellis.Strategy", "target_context" of "trellis.TargetContext".
std::string plain_name(const ObjectType& type) {
  std::string name;
  for (const char c : type.name.substr(type.name.find('.') + 1)) {
    const bool upper = std::isupper(static_cast<unsigned char>(c)) != 0;
    if (upper && !name.empty()) name += '_';
    name += upper ? static_cast<char>(std::tolower(static_cast<unsigned char>(c))) : c;
  }
  return name;
}

std::string text_of(const ObjectType& type) {
  std::string text = fmt::format("{} (type): {}\n", plain_name(type), type.summary);
  if (!type.operations.empty()) text += "\noperators:\n";
  const auto plain = [](const std::string& name) {
    for (const ObjectType& known : object_types()) {
      if (known.name == name) return plain_name(known);
    }
    return name;
  };
  for (const Operation& o : type.operations) {
    text += row(fmt::format("{} {} {}", plain_name(type), o.symbol, plain(o.operand)), "a " + plain(o.result));
  }
  const ObjectType* of = &type;
  if (!type.parent.empty()) {
    for (const ObjectType& parent : object_types()) of = parent.name == type.parent ? &parent : of;
  }
  if (!of->members.empty()) text += "\nto be read:\n";
  for (const Field& member : of->members) {
    const bool method = member.type.starts_with("fun(self");
    text +=
        row(method ? ':' + member.name + "()" : '.' + member.name, member.doc.empty() ? member.expects : member.doc);
  }
  return text;
}

/// Maps "D at least" to "d at least" and "re-solves" to "resolves".
std::string folded(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (c != '-' && c != ' ' && c != '_') text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

/// Returns the terms of reports with this name; all of them for "report". "" for none.
std::string report_words(const std::string& name) {
  std::string text;
  for (const ReportTerm& term : report_terms()) {
    if (name == "report" || folded(term.name) == folded(name)) text += row(term.name, term.meaning);
  }
  return text.empty() ? "" : "in reports:\n" + text;
}

}  // namespace

std::string vocabulary_text() {
  std::string text;
  const auto list = [&](Word::Kind kind, const char* title) {
    text += fmt::format("{}:\n", title);
    for (const Word& word : words()) {
      if (word.kind == kind && (kind != Word::Kind::function || word.module().empty())) {
        text += row(word.name, word.summary);
      }
    }
  };
  for (const auto& [kind, title] : {std::pair{Word::Kind::planner, "planners"},
                                    {Word::Kind::guide, "guides"},
                                    {Word::Kind::target, "targets"},
                                    {Word::Kind::estimator, "estimators"}}) {
    list(kind, title);
    text += '\n';
  }
  text += "composition:\n";
  for (const Combinator& combinator : combinators()) text += row(combinator.written, combinator.summary);
  text += '\n';
  list(Word::Kind::constructor, "constructors");
  text += '\n';
  list(Word::Kind::function, "functions");
  for (const Word& module : words()) {
    if (module.kind != Word::Kind::module) continue;
    text += fmt::format("\nmodule {}: {}\n{}", module.name, module.summary, contents(module.name));
  }
  text += "\nreport: the words of reports and their columns (help on 'report')\n";
  return text;
}

std::string help_text(const std::string& name) {
  std::vector<std::string> known = {"report"};
  std::string in_reports = report_words(name);
  for (const Word& word : words()) {
    if (word.name == name || fmt::format("{}.{}", word.kind_text(), word.name) == name) {
      std::string text = text_of(word);
      for (const ObjectType& type : object_types()) {
        if (plain_name(type) == name && !type.members.empty()) text += '\n' + text_of(type);
      }
      if (!in_reports.empty()) text += '\n' + in_reports;
      return text;
    }
    known.push_back(word.name);
  }
  for (const ObjectType& type : object_types()) {
    known.push_back(plain_name(type));
    if (plain_name(type) != name && type.name != name) continue;
    const std::string inside = contents(name);
    return text_of(type) + (inside.empty() ? "" : fmt::format("\nin {}:\n{}", name, inside));
  }
  if (!in_reports.empty()) return in_reports;
  for (const ReportTerm& term : report_terms()) known.push_back(term.name);
  throw Error(fmt::format("no help on '{}'{}; 'trellis help' lists all words", name, did_you_mean(name, known)));
}

}  // namespace trellis::dsl
