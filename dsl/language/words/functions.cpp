// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/functions.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <dsl/language/core/word.hpp>
#include <dsl/language/words/manipulator.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/strategy/registry.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

/// Writes a default in the syntax of a script.
std::string written(Value value) {
  if (value.type() == Type::table) {
    std::string text;
    value.each([&](std::size_t, Value element) { text += (text.empty() ? "" : ", ") + written(element); });
    return '{' + text + '}';
  }
  if (value.type() == Type::object) return "a " + value.text();
  return value.describe();
}

/// Returns the type name for descriptions of the language.
std::string type_of(const std::string& name) {
  constexpr std::array<std::pair<const char*, const char*>, 4> known = {{{"guide", "trellis.Guide"},
                                                                         {"strategy", "trellis.Strategy"},
                                                                         {"planner", "trellis.Planner"},
                                                                         {"problem", "trellis.Problem"}}};
  for (const auto& [word, type] : known) {
    if (name == word) return type;
  }
  return name;
}

/// Reads the description of one function, and the table of its defaults.
class DescriptionReader {
 public:
  /// \param defaults  receives the explicit defaults
  DescriptionReader(Stack& call, const std::vector<const Construct*>& constructs, Value description, Value defaults)
      : call_(call), constructs_(constructs), defaults_(defaults) {
    const auto text = [&](const char* field) { return description.field(field).string().value_or(""); };
    description.each([&](std::size_t i, Value value) {
      if (i == 1) construct_.name = value.string().value_or("");
      if (i == 2) construct_.summary = value.string().value_or("");
    });
    if (construct_.name.empty() || construct_.summary.empty()) {
      throw Error("native.define: a function needs its name and a line on what it does");
    }
    construct_.options.kind = Component::Kind::combinator;
    construct_.options.name = construct_.name;
    construct_.source = text("source");
    construct_.returns = type_of(text("returns"));
    construct_.usage = text("usage");
    const Value options = description.field("options");
    if (options.given()) read(options);
    if (construct_.usage.empty()) construct_.usage = construct_.name + "()";
  }

  Construct take() { return std::move(construct_); }

 private:
  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(fmt::format("native.define: {}: {}", construct_.name, fault));
  }

  void read(Value entry) {
    if (entry.type() != Type::table) fail("an option is described by a table");
    const lua::Keys keys = entry.keys();
    if (entry.field("like").given()) {
      read_like(entry);
    } else if (entry.field("name").given()) {
      read_one(entry);
    } else if (keys.length == 1 && !keys.names.empty()) {
      read_group(entry, keys.names);
    } else {
      entry.each([&](std::size_t, Value element) { read(element); });
    }
  }

  /// Returns the described part of that name: a planner, a guide, or a construct's options.
  [[nodiscard]] const Component& part(const std::string& name) const {
    for (const auto kind : {Component::Kind::planner, Component::Kind::guide}) {
      if (const Component* found = find_component(kind, name)) return *found;
    }
    for (const Construct* construct : constructs_) {
      if (construct->name == name) return construct->options;
    }
    fail(fmt::format("nothing is called '{}'", name));
  }

  void read_group(Value group, std::vector<std::string> names) {
    std::string of;
    group.each([&](std::size_t, Value value) { of = value.string().value_or(""); });
    const Component& component = part(of);
    for (const Option& option : component.options) {
      const auto found = std::find(names.begin(), names.end(), option.name);
      if (found == names.end()) continue;
      names.erase(found);
      add(option, group.field(option.name));
    }
    if (!names.empty()) fail(fmt::format("{} has no option '{}'", of, names.front()));
  }

  void read_one(Value entry) {
    const auto text = [&](const char* field) { return entry.field(field).string().value_or(""); };
    const std::string name = text("name");
    const Value value = entry.field("default");
    if (entry.field("type").given()) {
      add(Field{name, type_of(text("type")), text("expects"), text("doc"), false, text("default_text")}, value);
    } else {
      constexpr double infinity = std::numeric_limits<double>::infinity();
      Option option{name, Option::Type::number, text("unit"), 0.0, Range::any(), {}, text("doc")};
      option.range.lo = entry.field("lo").number().value_or(-infinity);
      option.range.hi = entry.field("hi").number().value_or(infinity);
      add(std::move(option), value);
    }
  }

  void read_like(Value entry) {
    const std::string name = entry.field("like").string().value_or("");
    const auto found =
        std::find_if(constructs_.begin(), constructs_.end(), [&](const Construct* c) { return c->name == name; });
    if (found == constructs_.end()) fail(fmt::format("there is no construct '{}'", name));
    const Value values = entry.field("default");
    for (Field field : (*found)->fields) {
      field.required = false;
      const Value value = values.field(field.name);
      add(std::move(field), value);
    }
    for (const Option& option : (*found)->options.options) add(option, values.field(option.name));
  }

  void add(Option option, Value value) {
    if (value.given()) {
      const Component alone{construct_.options.kind, construct_.name, "", "", {option}, {}};
      OptionValue given = false;
      if (const auto number = value.number()) given = *number;
      if (value.is_integer()) given = *value.integer();
      if (const auto text = value.string()) given = *text;
      if (const auto boolean = value.boolean()) given = *boolean;
      option.default_value = Options::validate(alone, {{option.name, given}}).at(option.name);
      set_default(option.name, value);
    }
    auto& options = construct_.options.options;
    const auto same =
        std::find_if(options.begin(), options.end(), [&](const Option& o) { return o.name == option.name; });
    if (same != options.end()) {
      *same = std::move(option);
    } else {
      options.push_back(std::move(option));
    }
  }

  void add(Field field, Value value) {
    if (value.given()) {
      field.default_text = written(value);
      set_default(field.name, value);
    }
    auto& fields = construct_.fields;
    const auto same = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == field.name; });
    if (same != fields.end()) {
      *same = std::move(field);
    } else {
      fields.push_back(std::move(field));
    }
  }

  void set_default(const std::string& name, Value value) {
    call_.push(value);
    call_.set_field(defaults_, name);
  }

  Stack& call_;
  const std::vector<const Construct*>& constructs_;
  Value defaults_;
  Construct construct_;
};

/// A function of the standard library.
struct Defined {
  Construct construct;
  lua::Reference defaults;
  lua::Reference make;
};

void check_field(const Construct& construct, const Field& field, const Arguments& arguments) {
  const Value value = arguments[field.name];
  if (!value.given()) return;
  const bool wrong = (field.type == "trellis.Planner" && value.get<PlannerSpec>() == nullptr) ||
                     ((field.type == "table" || field.type == "number[]") && value.type() != Type::table) ||
                     (field.type == "string" && value.type() != Type::string);
  if (wrong) arguments.reject(field.name);
  // A start, unless it is one of the other values that a start may be.
  const bool start = field.type.starts_with("number[]|table<string, number>|trellis.Pose") &&
                     value.get<Pose3>() == nullptr && value.get<LinkGoal>() == nullptr && !value.string() &&
                     (value.type() != Type::table || value.keys().names.empty());
  if (field.type == "number[]" || start) read_numbers(value, fmt::format("{}: field '{}'", construct.name, field.name));
}

int call_defined(const Defined& defined, Stack& call) {
  const Construct& construct = defined.construct;
  // Test this before pushing values: a pushed value would take the position of a missing argument.
  const bool given = call[1].given();
  if (call.count() > 1 || (given && call[1].type() != Type::table)) {
    throw Error(fmt::format("{}: takes a table of what shall differ, got {}", construct.name,
                            call.count() > 1 ? fmt::format("{} arguments", call.count()) : describe(call[1])));
  }
  const int before = call.size();
  defined.make.push(call);
  const Value all = call.push_table();
  const auto overlay = [&](Value with) {
    for (const auto& name : with.keys().names) {
      call.push(with.field(name));
      call.set_field(all, name);
    }
  };
  const int kept = call.size();
  defined.defaults.push(call);
  overlay(call.top());
  if (given) {
    lua::Faults faults;
    const Arguments arguments(construct, call, faults);
    if (!arguments.readable()) faults.raise();
    for (const Field& field : construct.fields) {
      faults.attempt([&] { check_field(construct, field, arguments); });
    }
    faults.attempt([&] { static_cast<void>(arguments.options()); });
    faults.raise();
    overlay(call[1]);
  }
  call.resize(kept);
  call.call_protected(1);
  return call.size() - before;
}

}  // namespace

lua::Callback definer(Definitions definitions) {
  return [definitions = std::move(definitions)](Stack& call) {
    const Value defaults = call.push_table();
    Construct construct = DescriptionReader(call, definitions.constructs, call[1], defaults).take();
    if (call[2].type() != Type::function) throw Error(fmt::format("native.define: {}: no function", construct.name));
    if (definitions.described) definitions.described(construct);
    const std::shared_ptr<const Defined> defined(new Defined{std::move(construct), {call, defaults}, {call, call[2]}});
    call.push_function([defined](Stack& use) { return call_defined(*defined, use); });
    return 1;
  };
}

}  // namespace trellis::dsl
