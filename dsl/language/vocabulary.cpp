// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/vocabulary.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include <dsl/language/algebra.hpp>
#include <dsl/language/experiment.hpp>
#include <dsl/language/measure.hpp>
#include <dsl/language/problem.hpp>
#include <dsl/language/publication.hpp>
#include <dsl/language/stdlib.hpp>
#include <dsl/language/world.hpp>
#include <trellis/strategy/registry.hpp>

namespace trellis::dsl {

namespace {

std::vector<const Component*> words_of(Component::Kind kind) {
  if (kind == Component::Kind::target) return target_components();
  if (kind == Component::Kind::estimator) return estimator_components();
  std::vector<const Component*> words;
  for (const Component* component : components()) {
    if (component->kind == kind) words.push_back(component);
  }
  return words;
}

/// The comment that a module begins with, without its licence line.
std::string head_of(const std::string& module) {
  std::string head;
  std::string_view text = module;
  while (text.starts_with("--")) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (line.find("SPDX-License-Identifier") != std::string_view::npos) continue;
    head += fmt::format("{}\n", line.substr(line.starts_with("-- ") ? 3 : 2));
  }
  return head;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// The name, and beside it the text in lines of a page's width.
std::string row(std::string name, std::string_view text) {
  constexpr std::size_t column = 76;
  std::string rows;
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

std::string options_text(const Component& component) {
  std::string text;
  for (const auto& option : component.options) {
    text += row(option.name, fmt::format("{}; default {}", expectation(option), to_string(option.default_value)));
    if (!option.doc.empty()) text += row("", option.doc);
  }
  return text;
}

std::string component_text(const Component& component) {
  std::string text = fmt::format("{} ({}): {}\n", component.name, to_string(component.kind), component.summary);
  if (!component.source.empty()) text += fmt::format("source: {}\n", component.source);
  std::string options = options_text(component);
  if (component.kind == Component::Kind::guide) {
    const GuideSpec guide = GuideSpec::make(component.name, {});
    if (const auto& planner = guide.planner()) {
      options += row("planner", fmt::format("a planner; default {}", planner->text()));
      options += row("", "searches the guide's own space");
    }
  }
  text += options.empty() ? "\nno options\n" : "\noptions:\n" + options;
  if (!component.positional.empty()) {
    std::string names;
    for (const auto& name : component.positional) names += (names.empty() ? "" : ", ") + name;
    text += fmt::format("\nwithout names: {}({})\n", component.name, names);
  }
  return text;
}

std::string construct_text(const Construct& construct) {
  std::string text = fmt::format("{}: {}\n\n  {}\n", construct.name, construct.summary, construct.usage);
  if (!construct.list.empty()) text += fmt::format("\nelements: {}\n", construct.list);
  if (!construct.fields.empty()) text += "\nfields:\n";
  for (const auto& field : construct.fields) {
    text += row(field.name, field.expects + (field.required ? "; required" : ""));
    text += row("", field.doc);
  }
  if (!construct.options.options.empty()) text += "\noptions:\n" + options_text(construct.options);
  return text;
}

}  // namespace

std::vector<const Construct*> constructs() {
  std::vector<const Construct*> all = {&sequence_construct(), &blend_construct(), &ablations_construct()};
  for (const Construct* construct : world_constructs()) all.push_back(construct);
  all.insert(all.end(), {&problem_construct(), &load_construct(), &target_construct(), &experiment_construct(),
                         &published_construct(), &claim_construct()});
  return all;
}

std::string vocabulary_text() {
  std::string text;
  for (const auto& [kind, title] : {std::pair{Component::Kind::planner, "planners"},
                                    {Component::Kind::guide, "guides"},
                                    {Component::Kind::target, "targets"},
                                    {Component::Kind::estimator, "estimators"}}) {
    text += fmt::format("{}:\n", title);
    for (const Component* component : words_of(kind)) text += row(component->name, component->summary);
    text += '\n';
  }
  text += "composition:\n";
  text += row("a >> b", "a guides the search in b's space; guide >> planner is a strategy");
  text += row("0.7*a + 0.3*b", "a mixture of guides");
  text += row("a .. b", "guides that take turns");
  text += row("blend { a, b }", "a mixture whose weights follow what each guide's proposals achieved");
  text += "\nconstructors:\n";
  for (const Construct* construct : constructs()) text += row(construct->name, construct->summary);
  text += "\nmodules:\n";
  for (const auto& name : module_names()) text += row(name, first_line(head_of(*module_text(name))));
  return text;
}

std::string help_text(const std::string& word) {
  std::vector<std::string> known;
  for (const auto kind :
       {Component::Kind::planner, Component::Kind::guide, Component::Kind::target, Component::Kind::estimator}) {
    for (const Component* component : words_of(kind)) {
      if (component->name == word) return component_text(*component);
      known.push_back(component->name);
    }
  }
  for (const Construct* construct : constructs()) {
    if (construct->name == word) return construct_text(*construct);
    known.push_back(construct->name);
  }
  for (const auto& name : module_names()) {
    if (name == word) return head_of(*module_text(name));
    known.push_back(name);
  }
  throw Error(fmt::format("no help on '{}'{}; 'trellis help' lists all words", word, did_you_mean(word, known)));
}

}  // namespace trellis::dsl
