// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/motion.hpp>

#include <fmt/format.h>

#include <utility>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Value;

const std::vector<Construct>& described() {
  static const std::vector<Construct> all = [] {
    std::vector<Construct> list;
    for (const MotionKind& kind : motion_kinds()) {
      const Component& component = *kind.component;
      const Option& first = component.options.front();
      list.push_back(
          {.name = "motion." + component.name,
           .usage = fmt::format("motion.{} {{ {} = {} }}", component.name, first.name, to_string(first.default_value)),
           .summary = component.summary,
           .list = "",
           .element = "",
           .fields = {},
           .options = component,
           .returns = "trellis.Motion"});
    }
    return list;
  }();
  return all;
}

}  // namespace

std::vector<const Construct*> motion_constructs() {
  std::vector<const Construct*> all;
  for (const Construct& construct : described()) all.push_back(&construct);
  return all;
}

void open_motion(Stack& stack) {
  stack.declare<Motion>({{"__tostring", [](Stack& call) {
                            const auto* model = call[1].get<Motion>();
                            return call.result(model != nullptr ? (*model)->text() : call[1].describe());
                          }}});
  const Value models = stack.push_table();
  for (const Construct& construct : described()) {
    const MotionKind& kind = *find_motion(construct.options.name);
    stack.push_function([&construct, &kind](Stack& call) {
      const Arguments arguments(construct, call);
      return call.result(kind.make(arguments.options()));
    });
    stack.set_field(models, kind.component->name);
  }
  stack.on_missing(models, missing_field("motion"));
  stack.set_global("motion");
}

}  // namespace trellis::dsl
