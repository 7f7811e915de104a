// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/offers.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include <dsl/language/measure.hpp>
#include <dsl/language/stdlib.hpp>
#include <dsl/language/tokens.hpp>
#include <dsl/language/vocabulary.hpp>
#include <trellis/strategy/registry.hpp>

namespace trellis::dsl {

namespace {

/// The constructors by name, those of modules as "robot.disc".
std::vector<std::string> names() {
  std::vector<std::string> all = module_names();
  for (const Component* component : components()) {
    const auto kind = component->kind;
    if (kind == Component::Kind::planner || kind == Component::Kind::guide) all.push_back(component->name);
  }
  for (const auto& more : {target_components(), estimator_components()}) {
    for (const Component* component : more) all.push_back(component->name);
  }
  for (const Construct* construct : constructs()) all.push_back(construct->name);
  return all;
}

void add_options(const Component& component, std::vector<std::string>& found) {
  for (const auto& option : component.options) found.push_back(option.name + " = ");
}

/// What may stand in the table that a constructor is given.
struct Fields {
  std::vector<std::string> names;
  bool elements = false;  ///< beside them, values without names
};

Fields fields(const std::string& constructor) {
  Fields found;
  for (const Component* component : components()) {
    if (component->name != constructor) continue;
    add_options(*component, found.names);
    if (component->kind == Component::Kind::guide) found.names.emplace_back("planner = ");
  }
  for (const auto& more : {target_components(), estimator_components()}) {
    for (const Component* component : more) {
      if (component->name == constructor) add_options(*component, found.names);
    }
  }
  for (const Construct* construct : constructs()) {
    if (construct->name != constructor) continue;
    for (const auto& field : construct->fields) found.names.push_back(field.name + " = ");
    add_options(construct->options, found.names);
    found.elements = !construct->list.empty();
  }
  return found;
}

/// The name that ends before token `end`, with what its dots lead through: "robot.disc"; "" without.
std::string path_before(const std::vector<Token>& all, std::size_t end) {
  std::string path;
  while (end > 0 && all[end - 1].kind == Token::Kind::name) {
    path.insert(0, all[end - 1].text);
    if (end < 2 || all[end - 2].text != ".") break;
    path = fmt::format(".{}", path);
    end -= 2;
  }
  return path;
}

/// The constructor whose table is open at the end; "" where it is no constructor's.
std::string open_table(const std::vector<Token>& all) {
  int closed = 0;
  for (std::size_t i = all.size(); i-- > 0;) {
    const std::string_view text = all[i].kind == Token::Kind::symbol ? all[i].text : "";
    if (text == "}" || text == ")" || text == "]") ++closed;
    if (text != "{" && text != "(" && text != "[") continue;
    if (closed > 0) {
      --closed;
      continue;
    }
    if (text != "{") return "";
    return path_before(all, i > 0 && all[i - 1].text == "(" ? i - 1 : i);
  }
  return "";
}

}  // namespace

std::vector<std::string> offers(const std::string& line) {
  std::vector<Token> all = tokens(line);
  if (!all.empty() && all.back().unfinished) return {};
  // The name at the cursor, and the names before it that its dots lead through.
  std::string word;
  const bool touching = !all.empty() && all.back().begin + all.back().text.size() == line.size();
  if (touching && (all.back().kind == Token::Kind::name || all.back().kind == Token::Kind::keyword)) {
    word = all.back().text;
    all.pop_back();
  }
  std::string before;
  if (!all.empty() && all.back().text == ".") before = path_before(all, all.size() - 1) + ".";

  std::vector<std::string> found;
  const auto offer = [&](const std::string& name) {
    if (name.starts_with(word)) found.push_back(name);
  };
  // In a constructor's table options stand at its beginning and behind its commas.
  bool elements = true;
  if (before.empty() && !all.empty() && (all.back().text == "{" || all.back().text == ",")) {
    const Fields open = fields(open_table(all));
    for (const auto& name : open.names) offer(name);
    elements = open.elements || found.empty();
  }
  for (const auto& name : names()) {
    if (!elements || !name.starts_with(before)) continue;
    offer(name.substr(before.size(), name.find('.', before.size()) - before.size()));
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace trellis::dsl
