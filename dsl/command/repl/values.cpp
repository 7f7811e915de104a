// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/repl/values.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <dsl/command/repl/source_text.hpp>
#include <dsl/language/core/types.hpp>
#include <dsl/language/words/algebra.hpp>
#include <trellis/base/error.hpp>
#include <trellis/report/views/table.hpp>

namespace trellis::command {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

// Runs as values -----------------------------------------------------------------------------------------------------

void push_count(Stack& call, std::uint64_t n) { call.push(static_cast<std::int64_t>(n)); }

void push_rows(Stack& call, const Configurations& rows) {
  const Value list = call.push_table();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Value row = call.push_table();
    for (const double x : rows[i]) {
      call.push(x);
      call.append(row);
    }
    call.append(list);
  }
}

void push_efficiency(Stack& call, const Efficiency& e) {
  const Value table = call.push_table();
  const auto set = [&](const char* name, double x) {
    if (std::isnan(x)) return;  // a missing value is nil
    call.push(x);
    call.set_field(table, name);
  };
  set("SE", e.value);
  set("SE_lo", e.value_lo);
  set("SE_hi", e.value_hi);
  set("above_uniform", e.above_uniform);
  set("uniform", e.uniform);
  set("coverage", e.coverage);
  push_count(call, e.samples);
  call.set_field(table, "samples");
}

void push_level(Stack& call, const LevelResult& level) {
  const LevelRecord& record = level.record;
  const Value table = call.push_table();
  const auto text = [&](const char* name, const std::string& value) {
    call.push(value);
    call.set_field(table, name);
  };
  const auto count = [&](const char* name, std::uint64_t value) {
    push_count(call, value);
    call.set_field(table, name);
  };
  count("level", static_cast<std::uint64_t>(record.level));
  text("name", record.name);
  text("space", record.space.name());
  text("planner", record.planner);
  text("status", std::string(to_string(record.solution.status)));
  count("solves", record.solves);
  count("proposals", record.search.proposals.size());
  count("nodes", record.search.nodes.size());
  count("checks", record.search.checks.validity);
  count("motion_checks", record.search.checks.motion);
  if (record.guided) {
    count("guided_checks", record.guided_checks);
    count("unguided_checks", record.unguided_checks);
    count("checks_below", record.checks_below);
  }
  call.push(record.search.seconds);
  call.set_field(table, "seconds");
  call.push(record.solution.solved());
  call.set_field(table, "solved");
  if (record.parent >= 0) count("parent", static_cast<std::uint64_t>(record.parent));
  if (!level.own) return;
  push_efficiency(call, level.own->tree);
  call.set_field(table, "tree");
  push_efficiency(call, level.own->expansion);
  call.set_field(table, "expansion");
}

using Readers = std::map<std::string, void (*)(Stack&, const Run&)>;

const Readers& readers() {
  static const Readers fields = {
      {"number", [](Stack& call, const Run& run) { push_count(call, run.number); }},
      {"name", [](Stack& call, const Run& run) { call.push(run.strategy_name); }},
      {"strategy", [](Stack& call, const Run& run) { call.push_object(run.strategy); }},
      {"problem", [](Stack& call, const Run& run) { call.push_object(run.problem); }},
      {"seed", [](Stack& call, const Run& run) { push_count(call, run.seed); }},
      {"solved", [](Stack& call, const Run& run) { call.push(run.result().run.solved); }},
      {"status", [](Stack& call, const Run& run) { call.push(to_string(run.result().run.status)); }},
      {"path", [](Stack& call, const Run& run) { push_rows(call, run.result().run.path); }},
      {"length", [](Stack& call, const Run& run) { call.push(run.result().run.length); }},
      {"seconds", [](Stack& call, const Run& run) { call.push(run.result().run.seconds); }},
      {"checks", [](Stack& call, const Run& run) { push_count(call, run.result().run.validity_checks); }},
      {"motion_checks", [](Stack& call, const Run& run) { push_count(call, run.result().run.motion_checks); }},
      {"proposals", [](Stack& call, const Run& run) { push_count(call, run.proposals); }},
      {"levels", [](Stack& call, const Run& run) {
         // Numbered as in reports: the root is level 0.
         const Value list = call.push_table();
         for (std::size_t i = 0; i < run.result().levels.size(); ++i) {
           push_level(call, run.result().levels[i]);
           call.set_index(list, i);
         }
       }}};
  return fields;
}

int read_field(Stack& call) {
  const auto* run = call[1].get<RunPointer>();
  const auto name = call[2].string();
  const auto field = name ? readers().find(*name) : readers().end();
  if (run == nullptr || field == readers().end()) {
    throw Error(fmt::format("a run has no field {}{}; it has: {}", call[2].describe(),
                            name ? did_you_mean(*name, run_fields()) : "", fmt::join(run_fields(), ", ")));
  }
  field->second(call, **run);
  return 1;
}

// Values as texts ----------------------------------------------------------------------------------------------------

class Writer {
 public:
  explicit Writer(Stack& stack) : stack_(stack) {}

  std::string table(Value value, std::size_t depth = 0) {
    constexpr std::size_t line = 96;
    const int before = stack_.size();
    std::vector<std::string> parts;
    const lua::Keys keys = value.keys();
    const bool list = keys.odd.empty();
    std::size_t left_out = 0;
    const auto add = [&](const std::string& key, Value element) {
      if (parts.size() >= most(depth)) {
        ++left_out;
      } else {
        parts.push_back(key + inner(element, depth + 1));
      }
    };
    if (list) {
      value.each([&](std::size_t, Value element) { add("", element); });
      for (const auto& name : keys.names) {
        add(key_text(name) + " = ", value.field(name));
        stack_.resize(before);
      }
    } else {
      value.each_pair([&](Value key, Value element) {
        const auto name = key.string();
        add((name ? key_text(*name) : fmt::format("[{}]", inner(key, depth + 1))) + " = ", element);
      });
      std::sort(parts.begin(), parts.end());
    }
    if (parts.empty()) return "{}";
    const std::string more = left_out > 0 ? fmt::format("-- and {} more", left_out) : "";
    std::size_t width = 4;
    bool broken = false;
    for (const auto& part : parts) {
      width += display_width(part) + 2;
      broken = broken || part.find('\n') != std::string::npos;
    }
    if (!broken && width + 2 * depth <= line && (more.empty() || depth > 0)) {
      // On a single line nothing may follow a comment.
      return fmt::format("{{ {}{} }}", fmt::join(parts, ", "), more.empty() ? "" : ", ...");
    }
    const std::string indent(2 * depth + 2, ' ');
    std::string out = "{\n";
    for (const auto& part : parts) out += indent + part + ",\n";
    if (!more.empty()) out += indent + more + "\n";
    return out + std::string(2 * depth, ' ') + "}";
  }

 private:
  static constexpr std::size_t deepest = 3;
  static constexpr int shown_digits = 6;
  static std::size_t most(std::size_t depth) { return depth == 0 ? 20 : 8; }

  std::string inner(Value value, std::size_t depth) {
    if (value.type() == Type::table) return depth > deepest ? "{...}" : table(value, depth);
    if (const auto text = value.string()) return quoted(*text);
    if (const auto number = value.number(); number && !value.is_integer()) return number_text(*number, shown_digits);
    return value.type() == Type::function ? "function" : value.text();
  }

  Stack& stack_;
};

std::string configuration_text(const Configuration& q) {
  std::vector<std::string> coordinates;
  coordinates.reserve(q.size());
  constexpr int digits = 4;
  for (const double x : q) coordinates.push_back(number_text(x, digits));
  return fmt::format("({})", fmt::join(coordinates, ", "));
}

std::string problem_text(const Problem& problem) {
  return fmt::format("problem '{}' in {}: the robot '{}' from {} to {}, {} obstacles\n", problem.name,
                     problem.space.name(), problem.scene->robot_name(), configuration_text(problem.start),
                     configuration_text(problem.goal()), problem.scene->obstacle_count());
}

}  // namespace

void open_runs(Stack& stack) {
  stack.declare<RunPointer>(
      {{"__index", read_field},
       {"__eq",
        [](Stack& call) {
          const auto* a = call[1].get<RunPointer>();
          const auto* b = call[2].get<RunPointer>();
          return call.result(a != nullptr && b != nullptr && *a == *b);
        }},
       {"__newindex", [](Stack&) -> int { throw Error("a run cannot be changed; plan(...) makes another"); }},
       {"__tostring", [](Stack& call) {
          const auto* run = call[1].get<RunPointer>();
          return call.result(run != nullptr ? outcome_text(**run) : call[1].describe());
        }}});
}

std::vector<std::string> run_fields() {
  std::vector<std::string> names;
  names.reserve(readers().size());
  for (const auto& [name, read] : readers()) names.push_back(name);
  return names;
}

std::string value_text(Stack& stack, Value value) {
  if (const auto strategy = dsl::as_strategy(value)) return strategy->tree();
  if (const auto* guide = value.get<GuideSpec>()) return guide->tree();
  if (const auto* problem = value.get<Problem>()) return problem_text(*problem);
  if (value.type() == Type::table) return Writer(stack).table(value) + "\n";
  constexpr int digits = 14;  // as Lua prints them
  const bool fraction = value.type() == Type::number && !value.is_integer();
  std::string text = fraction ? number_text(*value.number(), digits) : value.text();
  if (text.empty() || text.back() != '\n') text += '\n';
  return text;
}

}  // namespace trellis::command
