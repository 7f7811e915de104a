// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/tools/vocabulary.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

#include <dsl/language/core/replaced.hpp>
#include <dsl/language/tools/catalogue.hpp>
#include <dsl/language/tools/words.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/report/views/glossary.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/results/quantities.hpp>
#include <trellis/strategy/combinators.hpp>

namespace trellis::dsl {

namespace {

/// Returns the name, and beside it the text in lines of the page's width.
std::string row(std::string name, std::string_view text, std::size_t width) {
  constexpr std::size_t names = 18;
  constexpr std::size_t indent = names + 3;
  std::string above;
  if (name.size() > names) above = fmt::format("  {}\n", std::exchange(name, ""));
  return above + wrap(std::string(text), width, fmt::format("  {:<{}} ", name, names), std::string(indent, ' '));
}

/// Returns a line of text, and further ones below it.
std::string lines(const std::string& text, std::size_t width) { return wrap(text, width, "", "  "); }

/// Returns the values of a field, with its meaning below.
std::string rows_of(const Field& field, std::size_t width) {
  std::string text = field.expects;
  if (field.required) text += "; required";
  if (!field.default_text.empty()) text += "; default " + field.default_text;
  return row(field.name, text, width) + (field.doc.empty() ? "" : row("", field.doc, width));
}

std::string rows_of(const Option& option, std::size_t width) {
  return row(option.name, fmt::format("{}; default {}", expectation(option), default_text(option)), width) +
         (option.doc.empty() ? "" : row("", option.doc, width));
}

template <class T>
std::string section(const char* title, const std::vector<T>& entries, std::size_t width) {
  if (entries.empty()) return "";
  std::string text = fmt::format("\n{}:\n", title);
  for (const T& entry : entries) text += rows_of(entry, width);
  return text;
}

bool is_component(const Word& word) { return word.kind < Word::Kind::constructor; }

/// Returns the words of a table, without its name: of a module, or of the robots.
std::string contents(const std::string& module, std::size_t width) {
  std::string text;
  for (const Word& word : words()) {
    if (word.module() != module) continue;
    text += row(word.name.substr(module.size() + 1), word.summary.empty() ? "not described" : word.summary, width);
  }
  return text;
}

std::string component_text(const Word& word, std::size_t width) {
  std::string text = lines(fmt::format("{} ({}): {}", word.name, word.kind_text(), word.summary), width);
  if (!word.source.empty()) text += lines("source: " + word.source, width);
  if (const GuideKind* guide = word.kind == Word::Kind::guide ? find_guide(word.name) : nullptr) {
    text += '\n';
    for (const auto& [title, line] : claim_lines(guide->claims)) text += row(title, line, width);
  }
  std::string options;
  for (const Option& option : word.options) options += rows_of(option, width);
  for (const Field& field : word.fields) options += rows_of(field, width);
  text += options.empty() ? "\nno options\n" : "\noptions:\n" + options;
  if (!word.positional.empty()) {
    text += fmt::format("\nwithout names: {}({})\n", word.name, fmt::join(word.positional, ", "));
  }
  return text;
}

std::string construct_text(const Word& word, std::size_t width) {
  std::string text =
      lines(fmt::format("{}: {}", word.name, word.summary.empty() ? "not described" : word.summary), width);
  if (!word.source.empty()) text += lines("source: " + word.source, width);
  text += fmt::format("\n  {}\n", word.usage);
  if (!word.list.empty()) text += '\n' + lines("elements: " + word.list, width);
  text += section("arguments", word.arguments, width);
  text += section("fields", word.fields, width);
  text += section("options", word.options, width);
  return text;
}

std::string text_of(const Word& word, std::size_t width) {
  if (word.kind == Word::Kind::module) {
    const std::string inside = contents(word.name, width);
    return word.text + (inside.empty() ? "" : fmt::format("\nin {}:\n{}", word.name, inside));
  }
  return is_component(word) ? component_text(word, width) : construct_text(word, width);
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

/// Returns "a robot", "an outcome".
std::string a_value(const ObjectType& type) {
  const std::string name = plain_name(type);
  return (std::string_view("aeiou").find(name.front()) != std::string_view::npos ? "an " : "a ") + name;
}

/// Returns the line of a member of values: ".path", ":recentred()".
std::string row_of_member(const Field& member, std::size_t width) {
  const bool method = member.type.starts_with("fun(self");
  return row(method ? ':' + member.name + "()" : '.' + member.name, member.doc.empty() ? member.expects : member.doc,
             width);
}

std::string text_of(const ObjectType& type, std::size_t width) {
  std::string text = lines(fmt::format("{} (type): {}", plain_name(type), type.summary), width);
  if (!type.operations.empty()) text += "\noperators:\n";
  const auto plain = [](const std::string& name) {
    for (const ObjectType& known : object_types()) {
      if (known.name == name) return plain_name(known);
    }
    return name;
  };
  for (const Operation& o : type.operations) {
    text += row(fmt::format("{} {} {}", plain_name(type), o.symbol, plain(o.operand)), "a " + plain(o.result), width);
  }
  const ObjectType* of = &type;
  if (!type.parent.empty()) {
    for (const ObjectType& parent : object_types()) of = parent.name == type.parent ? &parent : of;
  }
  if (!of->members.empty()) text += "\nto be read:\n";
  for (const Field& member : of->members) text += row_of_member(member, width);
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
std::string report_words(const std::string& name, std::size_t width) {
  std::string text;
  for (const ReportTerm& term : report_terms()) {
    if (name == "report" || folded(term.name) == folded(name)) text += row(term.name, term.meaning, width);
  }
  return text.empty() ? "" : "in reports:\n" + text;
}

/// Returns the quantities of results with this name, or this name in a group; all of them for "quantities". "" for
/// none.
std::string quantity_words(const std::string& name, std::size_t width) {
  std::string text;
  for (const Quantity& quantity : quantities()) {
    if (name != "quantities" && name != quantity.name() && name != quantity.key) continue;
    const std::string symbol = *quantity.symbol == '\0' ? "" : fmt::format("{}, ", quantity.symbol);
    text += row(quantity.name(), symbol + described(quantity), width);
  }
  return text.empty() ? "" : "in results (JSON, CSV):\n" + text;
}

/// Whether `part` is one of the parts of `text` that blanks, dots, underscores and the like separate.
bool has_part(std::string_view text, std::string_view part) {
  const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) {
    std::size_t end = at + part.size();
    if (end < text.size() && text[end] == 's') ++end;  // a plural
    if ((at == 0 || !letter(text[at - 1])) && (end == text.size() || !letter(text[end]))) return true;
  }
  return false;
}

/// Returns the options, fields and members of this name, each meaning once with the words that have it; "" for none.
std::string options_text(const std::string& name, std::size_t width) {
  std::vector<std::pair<std::string, std::vector<std::string>>> meanings;
  const auto add = [&](const std::string& meaning, const std::string& word) {
    const auto found =
        std::find_if(meanings.begin(), meanings.end(), [&](const auto& entry) { return entry.first == meaning; });
    auto& entry = found != meanings.end() ? *found : meanings.emplace_back(meaning, std::vector<std::string>());
    entry.second.push_back(word);
  };
  for (const Word& word : words()) {
    for (const Option& option : word.options) {
      if (option.name == name) add(rows_of(option, width), word.name);
    }
    for (const Field& field : word.fields) {
      if (field.name == name) add(rows_of(field, width), word.name);
    }
  }
  for (const ObjectType& type : object_types()) {
    for (const Field& member : type.members) {
      if (member.name == name) add(row_of_member(member, width), a_value(type));
    }
  }
  if (meanings.empty()) return "";
  std::string text = fmt::format("{} is an option or a field\n", name);
  for (const auto& [meaning, of] : meanings) {
    text += '\n' + lines(fmt::format("of {}:", fmt::join(of, ", ")), width) + meaning;
  }
  return text;
}

/// Returns the words near a name, "" for none: those that have it as a part; those that make a value which it names,
/// such as box of an obstacle; constructors, then other words, whose summary names it.
std::string near_words(const std::string& name, std::size_t width) {
  constexpr std::size_t most = 14;
  const auto makes = [&](const Word& word) {
    const auto& types = object_types();
    return std::any_of(types.begin(), types.end(), [&](const ObjectType& type) {
      return type.name == word.returns && has_part(type.summary, name);
    });
  };
  std::vector<std::pair<int, const Word*>> found;
  for (const Word& word : words()) {
    if (has_part(word.name, name)) {
      found.emplace_back(0, &word);
    } else if (word.kind == Word::Kind::constructor && makes(word)) {
      found.emplace_back(1, &word);
    } else if (has_part(word.summary, name)) {
      found.emplace_back(word.kind == Word::Kind::constructor ? 2 : 3, &word);
    }
  }
  if (found.empty()) return "";
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  found.resize(std::min(found.size(), most));
  std::string text = fmt::format("no word is called '{}'; near it are\n\n", name);
  for (const auto& [rank, word] : found) text += row(word->name, word->summary, width);
  return text;
}

}  // namespace

std::string option_help(const std::string& name, std::size_t width) { return options_text(name, width); }

std::string vocabulary_text(std::size_t width) {
  std::string text;
  const auto list = [&](Word::Kind kind, const char* title) {
    text += fmt::format("{}:\n", title);
    for (const Word& word : words()) {
      if (word.kind == kind && (kind != Word::Kind::function || word.module().empty())) {
        text += row(word.name, word.summary, width);
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
  for (const Combinator& combinator : combinators()) text += row(combinator.written, combinator.summary, width);
  text += '\n';
  list(Word::Kind::constructor, "constructors");
  text += '\n';
  list(Word::Kind::function, "functions");
  for (const Word& module : words()) {
    if (module.kind != Word::Kind::module) continue;
    text +=
        '\n' + lines(fmt::format("module {}: {}", module.name, module.summary), width) + contents(module.name, width);
  }
  text += "\nreport: the words of reports and their columns (help on 'report')\n";
  text += "quantities: the numbers of results, in JSON and CSV (help on 'quantities')\n";
  return text;
}

std::string help_text(const std::string& name, std::size_t width) {
  if (name.empty()) return vocabulary_text(width);
  std::vector<std::string> known = {"report", "quantities"};
  std::string in_reports = report_words(name, width);
  if (const std::string numbers = quantity_words(name, width); !numbers.empty()) {
    in_reports += (in_reports.empty() ? "" : "\n") + numbers;
  }
  for (const Word& word : words()) {
    if (word.name == name || fmt::format("{}.{}", word.kind_text(), word.name) == name) {
      std::string text = text_of(word, width);
      for (const ObjectType& type : object_types()) {
        if (plain_name(type) == name && !type.members.empty()) text += '\n' + text_of(type, width);
      }
      if (!in_reports.empty()) text += '\n' + in_reports;
      return text;
    }
    known.push_back(word.name);
  }
  for (const ObjectType& type : object_types()) {
    known.push_back(plain_name(type));
    if (plain_name(type) != name && type.name != name) continue;
    const std::string inside = contents(name, width);
    return text_of(type, width) + (inside.empty() ? "" : fmt::format("\nin {}:\n{}", name, inside));
  }
  if (!in_reports.empty()) return in_reports;
  const std::string replacement = suggestion(name, {});
  for (const std::string& text :
       {options_text(name, width), replacement.empty() ? near_words(name, width) : std::string()}) {
    if (!text.empty()) return text;
  }
  for (const ReportTerm& term : report_terms()) known.push_back(term.name);
  for (const Quantity& quantity : quantities()) known.push_back(quantity.name());
  for (const Word& word : words()) {
    for (const Option& option : word.options) known.push_back(option.name);
    for (const Field& field : word.fields) known.push_back(field.name);
  }
  for (const ObjectType& type : object_types()) {
    for (const Field& member : type.members) known.push_back(member.name);
  }
  std::string offer = suggestion(name, known);
  // Else the longest name that it begins with: step of stepsize.
  constexpr std::size_t least = 4;
  const std::string* begins = nullptr;
  for (const std::string& one : known) {
    if (one.size() < least || !name.starts_with(one)) continue;
    if (begins == nullptr || one.size() > begins->size()) begins = &one;
  }
  if (offer.empty() && begins != nullptr) offer = fmt::format(" (did you mean '{}'?)", *begins);
  throw Error(fmt::format("no help on '{}'{}; 'trellis help' lists all words", name, offer));
}

}  // namespace trellis::dsl
