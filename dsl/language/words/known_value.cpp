// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/known_value.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <utility>

#include <dsl/language/words/configuration.hpp>
#include <dsl/language/words/world.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Value;

const std::vector<Field>& known_members() {
  static const std::vector<Field> members = {
      {"samples", "trellis.Sample[]", "", "the proposals in C so far, in their order"},
      {"new", "trellis.Sample[]", "", "those since f was last applied for this guide"},
      {"paths", "trellis.KnownPath[]", "", "the paths that the guides of C follow at present, this guide included"},
      {"refuted", "number[][]", "", "places of C where evidence refuted the path of a guide"}};
  return members;
}

void push_configurations(Stack& stack, const Configurations& rows) {
  const Value list = stack.push_table();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    push_numbers(stack, rows[i]);
    stack.append(list);
  }
}

void push_sample(Stack& stack, const Known::Sample& sample) {
  const Value table = stack.push_table();
  push_numbers(stack, sample.q);
  stack.set_field(table, "q");
  stack.push(fate_name(sample.fate));
  stack.set_field(table, "fate");
  stack.push(sample.mine);
  stack.set_field(table, "mine");
  for (const auto& [name, q] : {std::pair{"node", &sample.node}, {"blocked_at", &sample.blocked_at}}) {
    if (q->empty()) continue;
    push_numbers(stack, *q);
    stack.set_field(table, name);
  }
}

void push_samples(Stack& stack, const Known& known, std::size_t from) {
  const Value list = stack.push_table();
  for (std::size_t i = from; i < known.samples.size(); ++i) {
    push_sample(stack, known.samples[i]);
    stack.append(list);
  }
}

void push_paths(Stack& stack, const Known& known) {
  const Value list = stack.push_table();
  for (const Known::Path& path : known.paths) {
    const Value table = stack.push_table();
    stack.push(path.guide);
    stack.set_field(table, "guide");
    push_configurations(stack, path.points);
    stack.set_field(table, "path");
    stack.append(list);
  }
}

int read_known(Stack& call) {
  const auto* value = call[1].get<KnownValue>();
  value->members->push(call);
  const Value members = call.top();
  if (call.get(members, call[2]).given()) return 1;
  const std::string name = call[2].string().value_or("");
  const Known* known = value->access->known;
  if (known == nullptr) {
    throw Error(
        fmt::format("known.{}: the call that it was given to is over", name.empty() ? call[2].describe() : name));
  }
  if (name == "samples") {
    push_samples(call, *known, 0);
  } else if (name == "new") {
    push_samples(call, *known, known->new_from);
  } else if (name == "paths") {
    push_paths(call, *known);
  } else if (name == "refuted") {
    push_configurations(call, known->refuted);
  } else {
    throw no_member(call[2], known_members(), "known");
  }
  const Value list = call.top();
  call.push(list);
  call.set_field(members, name);
  return 1;
}

}  // namespace

std::string_view fate_name(Fate fate) {
  return fate == Fate::reached ? "reached" : fate == Fate::advanced ? "advanced" : "rejected";
}

void push_known(Stack& stack, const std::shared_ptr<const KnownAccess>& access) {
  const int before = stack.size();
  KnownValue value{access, std::make_shared<const lua::Reference>(stack, stack.push_table())};
  stack.resize(before);
  stack.push_object(std::move(value));
}

void open_known(Stack& stack) {
  stack.declare<KnownValue>(
      {{"__index", read_known}, {"__tostring", [](Stack& call) { return call.result(call[1].describe()); }}});
}

std::vector<ObjectType> known_types() {
  const std::string configuration = "number[]";
  std::vector<ObjectType> types;
  types.push_back({"trellis.Known", "what is known about C when f is applied", "", known_members(), {}});
  types.push_back({"trellis.Sample", "a proposal in C and what became of it", "", {}, {}});
  types.back().members = {{"q", configuration, "", "what was proposed"},
                          {"fate", "string", "", R"("reached", "advanced" (a node towards it) or "rejected")"},
                          {"mine", "boolean", "", "whether this guide drew it"},
                          {"node", configuration + "?", "", "the node that was added"},
                          {"blocked_at", configuration + "?", "", "the first configuration that was found invalid"}};
  types.push_back({"trellis.KnownPath", "the path that a guide of C follows", "", {}, {}});
  types.back().members = {{"guide", "string", "", "the guide as reports write it"},
                          {"path", "number[][]", "", "configurations of C, lifted from the guide's space"}};
  return types;
}

}  // namespace trellis::dsl
