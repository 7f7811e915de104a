// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/configuration.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace trellis::dsl {

using lua::Stack;
using lua::Value;

std::string axis_names(const Space& space) {
  std::string names;
  for (const Axis& axis : space.coordinates()) names += (names.empty() ? "" : ", ") + axis.name;
  return names;
}

std::string coordinates_of(View q) { return fmt::format("({:g})", fmt::join(q, ", ")); }

void push_numbers(Stack& stack, View numbers) {
  const Value list = stack.push_table();
  for (const double x : numbers) {
    stack.push(x);
    stack.append(list);
  }
}

namespace {

/// Pushes one entry for each axis.
template <class Push>
void set_list(Stack& stack, Value table, const char* name, const Space& space, const Push& push) {
  const Value list = stack.push_table();
  for (const Axis& axis : space.coordinates()) {
    push(axis);
    stack.append(list);
  }
  stack.set_field(table, name);
}

constexpr std::array<const char*, 8> space_fields = {"name",  "names",   "dimension", "lower",
                                                     "upper", "weights", "periodic",  "volume"};

/// Returns the axes of C in a list of names.
Space named_axes(Value list, const Space& c, const std::string& what) {
  std::vector<std::string> known;
  known.reserve(c.dimension());
  for (const Axis& axis : c.axes()) known.push_back(axis.name);
  std::vector<Axis> axes;
  list.each([&](std::size_t i, Value value) {
    const auto name = value.string();
    const auto found = std::find(known.begin(), known.end(), name.value_or(""));
    if (found == known.end()) {
      throw Error(fmt::format("{}: entry {} must be the name of an axis of C, got {}{}; there are: {}", what, i,
                              describe(value), name ? did_you_mean(*name, known) : "", fmt::join(known, ", ")));
    }
    axes.push_back(c.axes()[static_cast<std::size_t>(found - known.begin())]);
  });
  std::string name = "S";
  if (axes == c.axes()) name = c.name();
  return {std::move(name), std::move(axes)};
}

/// Reads one value for each axis with `read`.
template <class Read>
void read_list(Value table, const char* name, std::size_t count, const std::string& what, const Read& read) {
  const Value list = table.field(name);
  if (!list.given()) return;
  const bool fits = list.type() == lua::Type::table && list.keys().length == count;
  if (!fits) throw Error(fmt::format("{}: field '{}' must be a list of {} values", what, name, count));
  list.each([&](std::size_t i, Value value) {
    if (!read(i - 1, value)) {
      throw Error(fmt::format("{}: field '{}': entry {} cannot be {}", what, name, i, describe(value)));
    }
  });
}

bool read_number(Value value, double& into) {
  const auto number = value.number();
  if (number) into = *number;
  return number.has_value();
}

}  // namespace

void push_space(Stack& stack, const Space& space) {
  const Value table = stack.push_table();
  stack.push(space.name());
  stack.set_field(table, "name");
  stack.push(static_cast<std::int64_t>(space.dimension()));
  stack.set_field(table, "dimension");
  set_list(stack, table, "names", space, [&](const Axis& axis) { stack.push(axis.name); });
  set_list(stack, table, "lower", space, [&](const Axis& axis) { stack.push(axis.lo); });
  set_list(stack, table, "upper", space, [&](const Axis& axis) { stack.push(axis.hi); });
  set_list(stack, table, "weights", space, [&](const Axis& axis) { stack.push(axis.weight); });
  stack.push(std::exp(space.log_volume()));
  stack.set_field(table, "volume");
  set_list(stack, table, "periodic", space, [&](const Axis& axis) { stack.push(axis.periodic); });
}

Configuration read_configuration(Value value, const Space& space, const std::string& what) {
  Configuration q = read_numbers(value, what);
  if (q.size() == space.dimension()) return q;
  throw Error(fmt::format("{} must be a configuration of {} numbers ({}), got {}", what, space.dimension(),
                          axis_names(space), q.size()));
}

void read_coordinates(const Stack& stack, int first, int count, const Space& space, MutableView out,
                      const std::string& what) {
  if (count == 1 && stack[first].type() == lua::Type::table) {
    const Configuration q = read_configuration(stack[first], space, what);
    std::copy(q.begin(), q.end(), out.begin());
    return;
  }
  bool fits = static_cast<std::size_t>(count) == space.dimension();
  for (int i = 0; fits && i < count; ++i) {
    const auto number = stack[first + i].number();
    fits = number.has_value();
    if (!fits) break;
    if (!std::isfinite(*number)) {
      throw lua::Located(fmt::format("{} must be finite numbers: {} is {:g}", what,
                                     space.coordinates()[static_cast<std::size_t>(i)].name, *number));
    }
    out[static_cast<std::size_t>(i)] = *number;
  }
  if (fits) return;
  std::string got;
  for (int i = 0; i < count; ++i) got += (i > 0 ? ", " : "") + stack[first + i].describe();
  throw lua::Located(fmt::format("{} must be {} numbers ({}), got {}", what, space.dimension(), axis_names(space),
                                 count == 0 ? "nothing" : got));
}

ObjectType space_type() {
  ObjectType type{"trellis.Space", "a space of configurations", "", {}, {}};
  type.members = {{"name", "string", "", "SE(2), R^2, ..."},
                  {"dimension", "integer", "", "the number of axes"},
                  {"names", "string[]", "", "of the axes"},
                  {"lower", "number[]", "", "lower bounds, in metres or radians"},
                  {"upper", "number[]", "", "upper bounds, in metres or radians"},
                  {"weights", "number[]", "", "metres of the metric per unit of the axis"},
                  {"periodic", "boolean[]", "", "whether an axis wraps around"},
                  {"volume", "number", "", "in metric coordinates, which are the coordinates times their weights"}};
  return type;
}

Space read_space(Value value, const Space& c, const std::string& what) {
  if (value.type() != lua::Type::table) {
    throw Error(
        fmt::format("{} must be a space, as {{ names = {{\"x\"}}, lower = {{0}}, upper = {{1}} }}, or a list of "
                    "names of axes of C, got {}",
                    what, describe(value)));
  }
  const lua::Keys keys = value.keys();
  if (!keys.odd.empty()) throw Error(fmt::format("{} must be a space, got a table with {}", what, keys.odd));
  if (keys.names.empty()) return named_axes(value, c, what);
  const std::vector<std::string> known(space_fields.begin(), space_fields.end());
  for (const auto& name : keys.names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw Error(fmt::format("{}: a space has no field '{}'{}; it has: {}", what, name, did_you_mean(name, known),
                            fmt::join(known, ", ")));
  }
  for (const char* name : {"names", "lower", "upper"}) {
    if (!value.field(name).given()) throw Error(fmt::format("{}: a space needs the field '{}'", what, name));
  }
  std::vector<Axis> axes(value.field("names").type() == lua::Type::table ? value.field("names").keys().length : 0);
  read_list(value, "names", axes.size(), what, [&](std::size_t i, Value entry) {
    axes[i].name = entry.string().value_or("");
    return !axes[i].name.empty();
  });
  read_list(value, "lower", axes.size(), what,
            [&](std::size_t i, Value entry) { return read_number(entry, axes[i].lo); });
  read_list(value, "upper", axes.size(), what,
            [&](std::size_t i, Value entry) { return read_number(entry, axes[i].hi); });
  read_list(value, "weights", axes.size(), what,
            [&](std::size_t i, Value entry) { return read_number(entry, axes[i].weight); });
  read_list(value, "periodic", axes.size(), what, [&](std::size_t i, Value entry) {
    axes[i].periodic = entry.boolean().value_or(false);
    return entry.boolean().has_value();
  });
  if (axes.empty()) throw Error(fmt::format("{}: a space that is searched has at least one axis", what));
  return {value.field("name").string().value_or("S"), std::move(axes)};
}

void bring_into(const Space& space, MutableView q, const std::string& what) {
  space.normalise(q);
  const std::vector<Axis> axes = space.coordinates();
  for (std::size_t j = 0; j < q.size(); ++j) {
    const Axis& axis = axes[j];
    if (axis.periodic || (q[j] >= axis.lo && q[j] <= axis.hi)) continue;
    throw Error(fmt::format("{} must lie in the space {}: {} = {:g} is outside of [{:g}, {:g}]", what, space.name(),
                            axis.name, q[j], axis.lo, axis.hi));
  }
}

}  // namespace trellis::dsl
