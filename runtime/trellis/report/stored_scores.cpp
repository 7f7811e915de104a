// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/stored_scores.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

// Each `fields` calls `field(name, member)` for every member of a struct: one list serves the writer and the reader.

template <class Parts, class Field>
void chain_rule_fields(Parts& parts, const Field& field) {
  field("mass", parts.mass);
  field("spread", parts.spread);
  field("along", parts.along);
  field("across", parts.across);
}

template <class E, class Field>
void estimate_fields(E& e, const Field& field) {
  field("estimator", e.estimator);
  field("value", e.value);
  field("light_value", e.light_value);
  field("unregularised", e.unregularised);
  field("gain", e.gain);
  field("js", e.js);
  field("parts", e.parts);
  field("unregularised_parts", e.unregularised_parts);
}

template <class A, class Field>
void along_fields(A& along, const Field& field) {
  field("divergence", along.divergence);
  field("empty_share", along.empty_share);
  field("length", along.length);
  field("target", along.target);
  field("samples", along.samples);
  field("corrected", along.corrected);
  field("regularised", along.regularised);
}

template <class E, class Field>
void efficiency_fields(E& e, const Field& field) {
  estimate_fields(e, field);
  field("value_lo", e.value_lo);
  field("value_hi", e.value_hi);
  field("uniform", e.uniform);
  field("perfect", e.perfect);
  field("mass", e.mass);
  field("mass_lower95", e.mass_lower95);
  field("mass_lo", e.mass_lo);
  field("mass_hi", e.mass_hi);
  field("coverage", e.coverage);
  field("uniform_coverage", e.uniform_coverage);
  field("coverage_half", e.coverage_half);
  field("uniform_coverage_half", e.uniform_coverage_half);
  field("free_share", e.free_share);
  field("along", e.along);
  field("n", e.samples);
  field("in_target", e.in_target);
  field("repeated", e.repeated);
  field("others", e.others);
  field("flags", e.flags);
  field("reason", e.reason);
}

template <class M, class Field>
void metrics_fields(M& m, const Field& field) {
  field("classes", m.classes);
  field("nodes", m.nodes);
  field("components", m.components);
  field("coverage", m.coverage);
  field("connectivity", m.connectivity);
  field("information", m.information);
  field("information_per_sample", m.information_per_sample);
  field("invalid", m.invalid);
  field("trapped", m.trapped);
  field("redundant", m.redundant);
  field("useful", m.useful);
}

template <class L, class Field>
void level_fields(L& level, const Field& field) {
  field("own", level.own);
  field("root", level.root);
  field("own_cross", level.own_cross);
  field("root_cross", level.root_cross);
  field("equal", level.equal);
  field("oracle", level.oracle);
  field("uniform", level.uniform);
  field("metrics", level.metrics);
}

template <class T, class Field>
void fields(T& object, const Field& field) {
  using Plain = std::remove_const_t<T>;
  if constexpr (std::is_same_v<Plain, ChainRule>) chain_rule_fields(object, field);
  if constexpr (std::is_same_v<Plain, Estimate>) estimate_fields(object, field);
  if constexpr (std::is_same_v<Plain, Along>) along_fields(object, field);
  if constexpr (std::is_same_v<Plain, Efficiency>) efficiency_fields(object, field);
  if constexpr (std::is_same_v<Plain, SearchMetrics>) metrics_fields(object, field);
  if constexpr (std::is_same_v<Plain, LevelResult>) level_fields(object, field);
  if constexpr (std::is_same_v<Plain, Scores>) {
    field("tree", object.tree);
    field("expansion", object.expansion);
  }
  if constexpr (std::is_same_v<Plain, PooledScores>) {
    field("strategy", object.strategy);
    field("key", object.key);
    field("seeds", object.seeds);
    field("targets", object.targets);
    field("scores", object.scores);
  }
}

// Writing ----------------------------------------------------------------------------------------------------------

/// JSON has neither NaN nor infinity.
Json json_of(double x) {
  if (std::isnan(x)) return nullptr;
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  return x;
}
Json json_of(std::size_t x) { return x; }
Json json_of(const std::string& text) { return text; }
Json json_of(NodeClass c) { return static_cast<int>(c); }

template <class T>
Json json_of(const T& object);

template <class List>
Json list_of(const List& list) {
  Json out = Json::array();
  for (const auto& one : list) out.push_back(json_of(one));
  return out;
}
template <class T>
Json json_of(const std::vector<T>& list) {
  return list_of(list);
}
template <class T, std::size_t n>
Json json_of(const std::array<T, n>& list) {
  return list_of(list);
}
template <class T>
Json json_of(const std::optional<T>& maybe) {
  return maybe ? json_of(*maybe) : Json(nullptr);
}
template <class T>
Json json_of(const T& object) {
  Json out = Json::object();
  fields(object, [&](const char* name, const auto& member) { out[name] = json_of(member); });
  return out;
}

std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// Reading ----------------------------------------------------------------------------------------------------------

void read(const Json& json, double& x) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (json.is_null()) {
    x = std::numeric_limits<double>::quiet_NaN();
  } else if (json.is_string()) {
    x = json.get<std::string>() == "inf" ? infinity : -infinity;
  } else {
    x = json.get<double>();
  }
}
void read(const Json& json, std::size_t& x) { x = json.get<std::size_t>(); }
void read(const Json& json, std::string& text) { text = json.get<std::string>(); }
void read(const Json& json, NodeClass& c) {
  const int number = json.get<int>();
  if (number < 0 || number > static_cast<int>(NodeClass::invalid)) {
    throw Error(fmt::format("a node has class {}; there are 0 to {}", number, static_cast<int>(NodeClass::invalid)));
  }
  c = static_cast<NodeClass>(number);
}

template <class T>
void read(const Json& json, T& object);

template <class T>
void read(const Json& json, std::vector<T>& list) {
  list.resize(json.size());
  for (std::size_t i = 0; i < list.size(); ++i) read(json.at(i), list[i]);
}
template <class T, std::size_t n>
void read(const Json& json, std::array<T, n>& list) {
  for (std::size_t i = 0; i < n; ++i) read(json.at(i), list[i]);
}
template <class T>
void read(const Json& json, std::optional<T>& maybe) {
  maybe.reset();
  if (!json.is_null()) read(json, maybe.emplace());
}
template <class T>
void read(const Json& json, T& object) {
  fields(object, [&](const char* name, auto& member) { read(json.at(name), member); });
}

/// Calls `body` and replaces the exceptions of the JSON library.
template <class Body>
auto parsed(const char* what, Body body) {
  try {
    return body();
  } catch (const Json::exception&) {
    throw Error(fmt::format("this is no record of {}", what));
  }
}

const Json& levels_of(const Json& json, const RunResult& run) {
  const Json& levels = json.at("levels");
  if (levels.size() != run.levels.size()) {
    throw Error(fmt::format("the record has {} levels, the run has {}", levels.size(), run.levels.size()));
  }
  return levels;
}

/// Removes the fields that scoring sets.
Json without_scores(const std::string& line) {
  Json json = Json::parse(line);
  for (Json& level : json.at("levels")) {
    for (const char* name : {"efficiency", "root_efficiency", "coverage", "measure", "metrics"}) {
      level.erase(std::string(name));
    }
  }
  return json;
}

}  // namespace

std::string scores_line(const RunResult& run) {
  Json points = Json::array();
  for (const double x : run.target.values()) points.push_back(x);
  return dump({{"problem", run.problem},
               {"strategy", run.strategy},
               {"seed", run.seed},
               {"levels", json_of(run.levels)},
               {"target", {{"dimension", run.target.dimension()}, {"points", std::move(points)}}}});
}

void restore_scores(RunResult& run, const std::string& line) {
  parsed("scores", [&] {
    const Json json = Json::parse(line);
    const Json& levels = levels_of(json, run);
    for (std::size_t i = 0; i < levels.size(); ++i) read(levels[i], run.levels[i]);
    const Json& target = json.at("target");
    const auto points = target.at("points").get<std::vector<double>>();
    const auto dimension = target.at("dimension").get<std::size_t>();
    const std::size_t expected = run.levels.empty() ? dimension : run.levels.front().record.space.dimension();
    if (!points.empty() && dimension != expected) {
      throw Error(fmt::format("the target's points have {} coordinates, the run's have {}", dimension, expected));
    }
    run.target = Configurations(dimension);
    for (std::size_t i = 0; dimension > 0 && i + dimension <= points.size(); i += dimension) {
      run.target.push(View(points).subspan(i, dimension));
    }
  });
}

std::string pooled_line(const std::string& problem, const std::vector<PooledScores>& pooled) {
  return dump({{"problem", problem}, {"strategy", ""}, {"seed", 0}, {"pooled", json_of(pooled)}});
}

void restore_pooled(std::vector<PooledScores>& pooled, const std::string& line) {
  parsed("pooled scores", [&] {
    const Json json = Json::parse(line);
    for (const Json& one : json.at("pooled")) {
      PooledScores& scores = pooled.emplace_back();
      scores.problem = json.at("problem").get<std::string>();
      read(one, scores);
    }
  });
}

void restore_times(RunResult& run, const std::string& line) {
  parsed("a run", [&] {
    const Json json = Json::parse(line);
    read(json.at("time_s"), run.run.seconds);
    read(json.at("cpu_s"), run.cpu_seconds);
    read(json.at("path_cpu_s"), run.run.path_seconds);
    if (const auto lua = json.find("lua_s"); lua != json.end()) read(*lua, run.run.lua_seconds);
    if (const auto set_up = json.find("set_up_s"); set_up != json.end()) read(*set_up, run.run.set_up_seconds);
    const Json& improvements = json.at("improvements");
    for (std::size_t i = 0; i < std::min(improvements.size(), run.run.improvements.size()); ++i) {
      read(improvements[i].at("cpu_s"), run.run.improvements[i].cpu_seconds);
    }
    const Json& levels = levels_of(json, run);
    for (std::size_t i = 0; i < levels.size(); ++i) {
      read(levels[i].at("time_s"), run.levels[i].record.search.seconds);
    }
  });
}

bool equal_but_for_scores(const std::string& a, const std::string& b) {
  return a == b || parsed("a run", [&] { return without_scores(a) == without_scores(b); });
}

}  // namespace trellis
