// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/results/run_json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include <trellis/base/error.hpp>
#include <trellis/results/records.hpp>

namespace trellis::json {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double share_unit = 10000.0;

/// Names for programs: docs/formats.md fixes them, independent of the printed report.
constexpr std::array<std::pair<Status, const char*>, 8> status_names = {{{Status::untried, "untried"},
                                                                         {Status::solved, "solved"},
                                                                         {Status::budget_spent, "budget_spent"},
                                                                         {Status::no_path, "no_path"},
                                                                         {Status::invalid_start, "invalid_start"},
                                                                         {Status::invalid_goal, "invalid_goal"},
                                                                         {Status::interrupted, "interrupted"},
                                                                         {Status::paused, "paused"}}};

const Json& field(const Json& object, const char* name) {
  static const Json none;
  const auto found = object.is_object() ? object.find(name) : object.end();
  return object.is_object() && found != object.end() ? *found : none;
}

// The fields of each struct, for the writer and for the reader: `field(name, member)` is called for each of them.

template <class R, class Field>
void fields_of_run(R& run, const Field& field) {
  field("problem", run.problem);
  field("strategy", run.strategy);
  field("seed", run.seed);
  field("status", run.status);
  field("solved", run.solved);
  for (const RunQuantity& quantity : run_quantities()) {
    std::visit([&](auto member) { field(quantity.key, run.*member); }, quantity.field);
  }
  field("queries", run.queries);
  field("certified", run.certified);
  field("path", run.path);
  field("trajectory", run.trajectory);
  field("times", run.times);
  field("conflicts", run.conflicts);
  field("bounded_loss", run.bounded);
  field("improvements", run.improvements);
  field("reasons", run.reasons);
  field("levels", run.levels);
}

template <class L, class Field>
void fields_of_level(L& level, const Field& field) {
  field("level", level.level);
  field("parent", level.parent);
  field("depth", level.depth);
  field("key", level.key);
  field("name", level.name);
  field("space", level.space);
  field("dimension", level.dimension);
  field("degrees", level.degrees);
  field("planner", level.planner);
  field("solves", level.solves);
  field("resolved_for", level.resolves);
  field("exhausted", level.resolves.exhausted);
  field("limit_reached", level.resolves.limit_reached);
  field("proposals", level.proposals);
  field("accepted", level.accepted);
  field("sources", level.sources);
  field("nodes", level.nodes);
  field("validity_checks", level.validity_checks);
  field("motion_checks", level.motion_checks);
  field("time_s", level.seconds);
  field("status", level.status);
  field("rejections", level.rejections);
}

template <class B, class Field>
void fields_of_bound(B& law, const Field& field) {
  field("bound", law.bound);
  field("constant", law.constant.work);
  field("constant_checks", law.constant.checks);
  field("largest_step", law.largest_step.work);
  field("largest_step_checks", law.largest_step.checks);
  field("guided_work", law.guided.work);
  field("guided_checks", law.guided.checks);
  field("unguided_work", law.unguided.work);
  field("unguided_checks", law.unguided.checks);
  field("set_up_work", law.set_up);
  field("guides_set_up", law.guides_set_up);
  field("unguided_proposals", law.unguided_proposals);
}

template <class M, class Field>
void fields_of_metrics(M& m, const Field& field) {
  field("components", m.components);
  field("coverage", m.coverage);
  field("connectivity", m.connectivity);
  field("information", m.information);
  field("information_per_sample", m.information_per_sample);
}

template <class M, class Field>
void fields_of_shares(M& m, const Field& field) {
  field("invalid", m.invalid);
  field("trapped", m.trapped);
  field("redundant", m.redundant);
  field("useful", m.useful);
}

template <class T, class Field>
void fields(T& object, const Field& field) {
  using Plain = std::remove_const_t<T>;
  if constexpr (std::is_same_v<Plain, RunFacts>) fields_of_run(object, field);
  if constexpr (std::is_same_v<Plain, LevelFacts>) fields_of_level(object, field);
  if constexpr (std::is_same_v<Plain, BoundedLoss>) fields_of_bound(object, field);
  if constexpr (std::is_same_v<Plain, SearchMetrics>) fields_of_metrics(object, field);
  if constexpr (std::is_same_v<Plain, Improvement>) {
    field("checks", object.validity_checks);
    field("cpu_s", object.cpu_seconds);
    field("length", object.length);
  }
  if constexpr (std::is_same_v<Plain, std::pair<std::string, std::size_t>>) {
    field("name", object.first);
    field("proposals", object.second);
  }
  if constexpr (std::is_same_v<Plain, TeamTimes>) {
    field("at", object.at);
    field("makespan", object.makespan);
    field("sum_of_costs", object.sum_of_costs);
  }
  if constexpr (std::is_same_v<Plain, TeamConflict>) {
    field("touching", object.touching);
    field("robots", object.robots);
    field("at", object.at);
    field("from", object.from);
    field("to", object.to);
    field("resolved", object.resolved);
    field("checks", object.checks);
  }
  if constexpr (std::is_same_v<Plain, Trajectory>) {
    field("dt", object.dt);
    field("steps", object.steps);
    field("controls", object.controls);
  }
  if constexpr (std::is_same_v<Plain, Rejections>) {
    field("rejected", object.rejected);
    field("examined", object.examined);
    field("by", object.by);
  }
  if constexpr (std::is_same_v<Plain, Resolves>) {
    for (const ResolveReason& reason : resolve_reasons) field(reason.name, object.*reason.count);
  }
  if constexpr (std::is_same_v<Plain, Along>) {
    field("length", object.length);
    field("target", object.target);
    field("samples", object.samples);
  }
}

// Writing -------------------------------------------------------------------------------------------------------------

template <class T>
Json json_of(const T& object);

template <class T>
void add_fields(const T& object, Json& out) {
  fields(object, [&](const char* name, const auto& member) { out[name] = json_of(member); });
}

template <class List>
Json list_of(const List& list) {
  Json out = Json::array();
  for (const auto& one : list) out.push_back(json_of(one));
  return out;
}

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

Json spent(std::uint64_t checks, std::uint64_t proposals) {
  return {{"validity_checks", checks}, {"proposals", proposals}};
}

/// The costs of both sides of bounded loss.
Json spent_json(const LevelFacts& level) {
  if (!level.guided) return nullptr;
  return {{"guided", spent(level.guided_checks, level.guided_proposals)},
          {"unguided", spent(level.unguided_checks, level.proposals - level.guided_proposals)},
          {"below", spent(level.checks_below, level.proposals_below)}};
}

Json rows_of(const Configurations& path) {
  Json out = Json::array();
  for (std::size_t i = 0; i < path.size(); ++i) {
    Json& row = out.emplace_back(Json::array());
    for (const double x : path[i]) row.push_back(number(x));
  }
  return out;
}

template <class T>
Json json_of(const T& object) {
  if constexpr (std::is_same_v<T, double>) {
    return number(object);
  } else if constexpr (std::is_same_v<T, int>) {
    return object < 0 ? Json(nullptr) : Json(object);
  } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
    return object;
  } else if constexpr (std::is_same_v<T, Status>) {
    for (const auto& [status, name] : status_names) {
      if (status == object) return name;
    }
    throw Fault("unknown status");
  } else if constexpr (std::is_same_v<T, TeamConflict::Resolved>) {
    return resolved_names().at(static_cast<std::size_t>(object));
  } else if constexpr (std::is_same_v<T, Configurations>) {
    return rows_of(object);
  } else if constexpr (IsOptional<T>::value) {
    return object ? json_of(*object) : Json(nullptr);
  } else if constexpr (IsVector<T>::value) {
    return list_of(object);
  } else {
    if constexpr (std::is_same_v<T, BoundedLoss>) {
      if (object.bound == 0.0) return nullptr;
    }
    if constexpr (std::is_same_v<T, Trajectory>) {
      if (!(object.dt > 0.0)) return nullptr;
    }
    Json out = Json::object();
    add_fields(object, out);
    if constexpr (std::is_same_v<T, Trajectory>) out["duration_s"] = number(object.duration());
    if constexpr (std::is_same_v<T, LevelFacts>) {
      out["solved"] = object.status == Status::solved;
      out["spent"] = spent_json(object);
      add_scores(object.scores.get(), object.level == 0, out);
    }
    return out;
  }
}

/// The chosen quantities; of those that reports bound, `estimates` has the value itself where it differs.
/// \param chosen  whether to write a quantity
template <class Chosen>
Json quantities_json(const Efficiency& scored, const Chosen& chosen) {
  const Efficiency bounded = shown(scored);
  Json out = Json::object();
  Json estimates = Json::object();
  for (const MeasureQuantity& quantity : measure_quantities) {
    if (!chosen(quantity)) continue;
    const double x = quantity.of_run(bounded);
    place_of(quantity, out) = number(x);
    const double estimate = quantity.of_run(scored);
    const bool same = x == estimate || (std::isnan(x) && std::isnan(estimate));
    if (!same && quantity.field != nullptr) place_of(quantity, estimates) = number(estimate);
  }
  if (!estimates.empty()) out["estimates"] = std::move(estimates);
  // Most sets are scored in no balls.
  for (const char* group : {"hitting", "bottleneck"}) {
    const auto found = out.find(group);
    if (found == out.end()) continue;
    if (std::all_of(found->begin(), found->end(), [](const Json& x) { return x.is_null(); })) *found = nullptr;
  }
  return out;
}

/// The chosen quantities of one estimator.
template <class Chosen>
Json estimate(const Estimate& by, const Efficiency& of, const Chosen& chosen) {
  Efficiency one = of;
  static_cast<Estimate&>(one) = by;
  one.others.clear();
  return quantities_json(one, chosen);
}

/// Why reports print no interval of SE; null where they print one, and where there is no value.
Json blank_json(const Efficiency& e) {
  if (std::isnan(e.value)) return nullptr;
  const std::string reason = blank_reason(e.value_lo, e.value_hi, e.uniform);
  return reason.empty() ? Json(nullptr) : Json(reason);
}

Json both_roles(const std::optional<Scores>& scores) {
  return {{"tree", measured_set(scores ? &scores->tree : nullptr)},
          {"expansion", measured_set(scores ? &scores->expansion : nullptr)}};
}

/// \param contents  of the sets on the own path
Json roles_json(const std::optional<Scores>& self, const std::optional<Scores>& cross, Contents contents) {
  Json out = Json::object();
  for (const auto& [name, role] : {std::pair{"tree", &Scores::tree}, std::pair{"expansion", &Scores::expansion}}) {
    out[name] = {{"self", measured_set(self ? &((*self).*role) : nullptr, contents)},
                 {"cross", measured_set(cross ? &((*cross).*role) : nullptr)}};
  }
  return out;
}

Json metrics_json(const SearchMetrics& metrics) {
  Json out = Json::object();
  for (std::size_t c = 0; c < metrics.nodes.size(); ++c) {
    out["nodes"][std::string(to_string(static_cast<NodeClass>(c)))] = metrics.nodes[c];
  }
  add_fields(metrics, out);
  fields_of_shares(metrics, [&](const char* name, double share) { out["proposals"][name] = number(share); });
  return out;
}

// Reading -------------------------------------------------------------------------------------------------------------

double read_number(const Json& json) {
  if (json.is_string()) return json.get<std::string>() == "-inf" ? -infinity : infinity;
  return json.is_number() ? json.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

template <class T>
void read(const Json& json, T& object);

/// Leaves what the document, which may be older, does not have.
template <class T>
void read_fields(const Json& json, T& object) {
  fields(object, [&](const char* name, auto& member) {
    if (const auto found = json.find(name); found != json.end()) read(*found, member);
  });
}

Configurations read_rows(const Json& json) {
  Configurations result(json.empty() ? 0 : json.front().size());
  for (const Json& entry : json) {
    Configuration row;
    for (const Json& x : entry) row.push_back(read_number(x));
    if (row.size() != result.dimension()) throw Error("configurations of a path have different dimensions");
    result.push(row);
  }
  return result;
}

void read_spent(const Json& json, LevelFacts& level) {
  level.guided = json.is_object();
  if (!level.guided) return;
  const auto side = [&](const char* name, std::uint64_t& checks, std::uint64_t* proposals) {
    checks = json.at(name).at("validity_checks").get<std::uint64_t>();
    if (proposals != nullptr) *proposals = json.at(name).at("proposals").get<std::uint64_t>();
  };
  side("guided", level.guided_checks, &level.guided_proposals);
  side("unguided", level.unguided_checks, nullptr);
  side("below", level.checks_below, &level.proposals_below);
}

template <class T>
void read(const Json& json, T& object) {
  if constexpr (std::is_same_v<T, double>) {
    object = read_number(json);
  } else if constexpr (std::is_same_v<T, int>) {
    object = json.is_null() ? -1 : json.get<int>();
  } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
    object = json.get<T>();
  } else if constexpr (std::is_same_v<T, Status>) {
    for (const auto& [status, name] : status_names) {
      if (json == name) object = status;
    }
  } else if constexpr (std::is_same_v<T, TeamConflict::Resolved>) {
    for (std::size_t i = 0; i < resolved_names().size(); ++i) {
      if (json == resolved_names()[i]) object = static_cast<TeamConflict::Resolved>(i);
    }
  } else if constexpr (std::is_same_v<T, Configurations>) {
    object = read_rows(json);
  } else if constexpr (IsOptional<T>::value) {
    object.reset();
    if (!json.is_null()) read(json, object.emplace());
  } else if constexpr (IsVector<T>::value) {
    object.resize(json.size());
    for (std::size_t i = 0; i < object.size(); ++i) read(json.at(i), object[i]);
  } else {
    if constexpr (std::is_same_v<T, std::pair<std::string, std::size_t>>) {
      if (json.is_array()) {  // of a table
        read(json.at(0), object.first);
        read(json.at(1), object.second);
      }
    }
    if (!json.is_object()) return;
    read_fields(json, object);
    if constexpr (std::is_same_v<T, BoundedLoss>) object.unguided_won = field(json, "won") == "unguided";
    if constexpr (std::is_same_v<T, LevelFacts>) {
      object.key = json.at("key").template get<std::string>();
      if (!json.contains("degrees")) object.degrees = object.dimension;
      read_spent(field(json, "spent"), object);
      object.scores = read_scores(json, object.level == 0);
    }
    if constexpr (std::is_same_v<T, Trajectory>) {
      if (object.controls.size() != object.steps.size()) {
        throw Error("a trajectory has another number of controls than of steps");
      }
    }
  }
}

/// Reads the quantities that an object has.
void read_quantities(const Json& json, Efficiency& e) {
  for (const Json* object : {&json, &field(json, "estimates")}) {
    for (const MeasureQuantity& quantity : measure_quantities) {
      if (quantity.field == nullptr || !object->is_object()) continue;
      const Json& group = *quantity.group == '\0' ? *object : field(*object, quantity.group);
      if (group.is_object() && group.contains(quantity.key)) quantity.field(e) = read_number(group.at(quantity.key));
    }
  }
}

std::optional<Scores> read_roles(const Json& tree, const Json& expansion) {
  // Documents of before have sets whose values are all null.
  if (!field(tree, "N").is_number()) return std::nullopt;
  return Scores{read_measured_set(tree), read_measured_set(expansion)};
}

std::optional<Scores> read_roles(const Json& roles, const char* paths) {
  return read_roles(field(field(roles, "tree"), paths), field(field(roles, "expansion"), paths));
}

std::optional<SearchMetrics> read_metrics(const Json& json) {
  if (!json.is_object()) return std::nullopt;
  SearchMetrics metrics;
  for (std::size_t c = 0; c < metrics.nodes.size(); ++c) {
    const std::string name(to_string(static_cast<NodeClass>(c)));
    metrics.nodes[c] = json.at("nodes").at(name).get<std::size_t>();
  }
  read_fields(json, metrics);
  // Tables leave out what is missing.
  fields_of_shares(
      metrics, [&](const char* name, double& share) { share = read_number(field(field(json, "proposals"), name)); });
  return metrics;
}

// The tables of documents ---------------------------------------------------------------------------------------------

/// Where a document has the scores of a level.
struct SetPlace {
  const char* space;  ///< the samples lie in the level's own one, or are lifted to the root's
  const char* path;
  std::optional<Scores> LevelScores::*scores;
};
constexpr std::array<SetPlace, 7> set_places = {{{"own", "self", &LevelScores::own},
                                                 {"own", "cross", &LevelScores::own_cross},
                                                 {"root", "self", &LevelScores::root},
                                                 {"root", "cross", &LevelScores::root_cross},
                                                 {"root", "oracle", &LevelScores::oracle},
                                                 {"root", "uniform", &LevelScores::uniform},
                                                 {"root", "equal_samples", &LevelScores::equal}}};
constexpr std::array<std::pair<const char*, Efficiency Scores::*>, 2> set_roles = {
    {{"tree", &Scores::tree}, {"expansion", &Scores::expansion}}};

/// A list of objects with a name and a number as pairs.
Json pairs_of(const Json& list) {
  Json out = Json::array();
  for (const Json& one : list) out.push_back({one.at("name"), one.at("proposals")});
  return out;
}

/// The shares in the parts of a path, in ten thousandths.
Json shares(const std::vector<double>& of) {
  Json out = Json::array();
  for (const double share : of) out.push_back(static_cast<int>(std::lround(share_unit * share)));
  return out;
}
std::vector<double> read_shares(const Json& json) {
  std::vector<double> out;
  if (!json.is_array()) return out;
  for (const Json& share : json) out.push_back(share.get<double>() / share_unit);
  return out;
}

/// The fields of a level without its scores.
Json level_row(const LevelFacts& level, std::size_t run) {
  LevelFacts plain = level;
  plain.scores = nullptr;
  Json row = {{"run", run}};
  row.update(json_of(plain));
  row.erase("measure");
  row["sources"] = pairs_of(row.at("sources"));
  if (Json& rejections = row["rejections"]; rejections.is_object()) rejections["by"] = pairs_of(rejections.at("by"));
  // Of a level without them, nothing: a table has no objects.
  for (const char* object : {"rejections", "spent", "metrics"}) {
    if (row.at(object).is_null()) row.erase(object);
  }
  if (level.scores && level.scores->metrics) row["metrics"] = metrics_json(*level.scores->metrics);
  return row;
}

}  // namespace

Json number(double x) {
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  return std::isnan(x) ? Json(nullptr) : Json(x);
}

Json& place_of(const Quantity& quantity, Json& object) {
  Json& group = *quantity.group == '\0' ? object : object[quantity.group];
  return group[quantity.key];
}

Json estimate(const Estimate& by, const Efficiency& of) {
  return estimate(by, of, [](const MeasureQuantity& quantity) { return quantity.of_estimate; });
}

Json measured_set(const Efficiency* scored, Contents contents) {
  if (scored == nullptr) return nullptr;
  const bool all = contents == Contents::all;
  Json out = quantities_json(*scored, [all](const MeasureQuantity& quantity) { return all || quantity.in_runs; });
  if (contents != Contents::reported) add_fields(scored->along, out["along"]);
  if (all) out["repeated"] = scored->repeated;
  const Efficiency bounded = shown(*scored);
  Json others = Json::object();
  for (const Estimate& other : scored->others) {
    others[other.estimator] = estimate(other, *scored, [](const MeasureQuantity& one) { return one.is("SE"); });
  }
  out.update({{"N", scored->samples},
              {"n", scored->in_target},
              {"estimator", std::isnan(scored->value) ? Json(nullptr) : Json(scored->estimator)},
              {"others", std::move(others)},
              {"flags", scored->flags},
              {"blank", blank_json(bounded)},
              {"reason", scored->reason.empty() ? Json(nullptr) : Json(scored->reason)}});
  return out;
}

Efficiency read_measured_set(const Json& json) {
  Efficiency e;
  if (!json.is_object()) return e;
  read_quantities(json, e);
  read(field(json, "along"), e.along);
  const auto count = [&](const char* name) {
    return field(json, name).is_number() ? json.at(name).get<std::size_t>() : 0;
  };
  e.samples = count("N");
  e.in_target = count("n");
  e.repeated = count("repeated");
  const auto text = [&](const char* name, std::string& to) {
    if (field(json, name).is_string()) to = json.at(name).get<std::string>();
  };
  text("estimator", e.estimator);
  text("reason", e.reason);
  e.flags = json.at("flags").get<std::vector<std::string>>();
  for (const auto& [name, other] : json.at("others").items()) {
    Efficiency one;
    read_quantities(other, one);
    one.estimator = name;
    e.others.push_back(one);
  }
  return e;
}

void add_scores(const LevelScores* scores, bool root, Json& level) {
  level["measure"] = nullptr;
  level["metrics"] = scores != nullptr && scores->metrics ? metrics_json(*scores->metrics) : Json(nullptr);
  if (scores == nullptr) return;
  // The default report scores the root lifted alone.
  const auto& self = root && !scores->own ? scores->root : scores->own;
  const auto& cross = root && !scores->own_cross ? scores->root_cross : scores->own_cross;
  Json& measure = level["measure"] = roles_json(self, cross, Contents::profile);
  if (!root) measure["root"] = roles_json(scores->root, scores->root_cross, Contents::reported);
  if (scores->oracle) measure["oracle"] = both_roles(scores->oracle);
  if (scores->uniform) measure["uniform"] = both_roles(scores->uniform);
  if (scores->equal) measure["equal_samples"] = both_roles(scores->equal);
}

std::shared_ptr<LevelScores> read_scores(const Json& level, bool root) {
  const Json& measure = field(level, "measure");
  if (!measure.is_object() && !field(level, "metrics").is_object()) return nullptr;
  auto scores = std::make_shared<LevelScores>();
  scores->own = read_roles(measure, "self");
  scores->own_cross = read_roles(measure, "cross");
  scores->root = root ? scores->own : read_roles(field(measure, "root"), "self");
  scores->root_cross = root ? scores->own_cross : read_roles(field(measure, "root"), "cross");
  for (const auto& [name, to] : {std::pair{"oracle", &scores->oracle}, std::pair{"uniform", &scores->uniform},
                                 std::pair{"equal_samples", &scores->equal}}) {
    *to = read_roles(field(field(measure, name), "tree"), field(field(measure, name), "expansion"));
  }
  scores->metrics = read_metrics(field(level, "metrics"));
  return scores;
}

void add_set(const Efficiency& set, bool profile, Json& row) {
  for (const MeasureQuantity& quantity : measure_quantities) {
    if (quantity.in_runs && quantity.field != nullptr) place_of(quantity, row) = number(quantity.of_run(set));
  }
  if (profile) {
    row["along"]["length"] = number(set.along.length);
    row["along"]["target"] = shares(set.along.target);
    row["along"]["samples"] = shares(set.along.samples);
  }
  Json others = Json::array();
  for (const Estimate& other : set.others) others.push_back({other.estimator, number(other.value)});
  row["N"] = set.samples;
  row["n"] = set.in_target;
  row["estimator"] = std::isnan(set.value) ? Json(nullptr) : Json(set.estimator);
  row["others"] = std::move(others);
  row["flags"] = set.flags;
  row["reason"] = set.reason.empty() ? Json(nullptr) : Json(set.reason);
}

Efficiency read_set(const Json& row) {
  Efficiency e;
  read_quantities(row, e);
  read(field(field(row, "along"), "length"), e.along.length);
  e.along.target = read_shares(field(field(row, "along"), "target"));
  e.along.samples = read_shares(field(field(row, "along"), "samples"));
  e.samples = row.at("N").get<std::size_t>();
  e.in_target = row.at("n").get<std::size_t>();
  if (row.at("estimator").is_string()) e.estimator = row.at("estimator").get<std::string>();
  if (const Json& reason = field(row, "reason"); reason.is_string()) e.reason = reason.get<std::string>();
  row.at("flags").get_to(e.flags);
  for (const Json& other : row.at("others")) {
    Estimate& one = e.others.emplace_back();
    one.estimator = other.at(0).get<std::string>();
    one.value = read_number(other.at(1));
  }
  return e;
}

std::string RunTables::add(const RunFacts& run) {
  RunFacts alone = run;
  alone.levels.clear();
  Json entry = json::run(alone);
  entry.erase("levels");
  for (const char* rare : {"trajectory", "times"}) {
    if (entry.at(rare).is_null()) entry.erase(rare);
  }
  for (const LevelFacts& level : run.levels) {
    levels_.add(level_row(level, runs_));
    if (!level.scores) continue;
    for (const SetPlace& place : set_places) {
      const auto* scores = &((*level.scores).*place.scores);
      // The own space of the root is the root's; the default report scores the root lifted alone.
      const bool own = std::string_view(place.space) == "own";
      if (level.level == 0 && own) continue;
      if (level.level == 0 && place.scores == &LevelScores::root && level.scores->own) scores = &level.scores->own;
      if (level.level == 0 && place.scores == &LevelScores::root_cross && level.scores->own_cross) {
        scores = &level.scores->own_cross;
      }
      if (!*scores) continue;
      const bool profile = std::string_view(place.path) == "self" && (own || level.level == 0);
      for (const auto& [role, of] : set_roles) {
        Json row = {
            {"run", runs_}, {"level", level.level}, {"space", place.space}, {"path", place.path}, {"role", role}};
        add_set((**scores).*of, profile, row);
        measure_.add(row);
      }
    }
  }
  if (run.set_up > 0.0) {
    const auto same = [&](const SetUp& one) { return one.problem == run.problem && one.strategy == run.strategy; };
    // The last ones first: runs come in the order of problems and strategies.
    const auto known = std::find_if(set_ups_.rbegin(), set_ups_.rend(), same);
    SetUp& found = known != set_ups_.rend() ? *known : set_ups_.emplace_back();
    found.problem = run.problem;
    found.strategy = run.strategy;
    found.seconds = std::max(found.seconds, run.set_up_seconds);
    found.shared_seconds = std::max(found.shared_seconds, run.shared_set_up_seconds);
    found.work = std::max(found.work, run.set_up);
    found.queries = std::max(found.queries, std::isnan(run.queries) ? 1.0 : run.queries);
  }
  ++runs_;
  return dump(entry);
}

std::string RunTables::text() const {
  ColumnWriter set_ups;
  for (const SetUp& one : set_ups_) {
    set_ups.add({{"problem", one.problem},
                 {"strategy", one.strategy},
                 {"set_up_s", number(one.seconds)},
                 {"shared_set_up_s", number(one.shared_seconds)},
                 {"set_up_work", number(one.work)},
                 {"queries", number(one.queries)}});
  }
  return " \"levels\": " + levels_.text() + ",\n \"measure\": " + measure_.text() +
         ",\n \"setups\": " + set_ups.text() + ",\n";
}

void read_tables(const Json& levels, const Json& measure, std::vector<RunFacts>& runs) {
  const ColumnReader of_levels(levels);
  for (std::size_t i = 0; i < of_levels.rows(); ++i) {
    const Json row = of_levels.row(i);
    LevelFacts level;
    read(row, level);
    runs.at(row.at("run").get<std::size_t>()).levels.push_back(std::move(level));
  }
  const ColumnReader of_measure(measure);
  std::map<std::pair<std::size_t, std::size_t>, std::shared_ptr<LevelScores>> found;
  for (std::size_t i = 0; i < of_measure.rows(); ++i) {
    const Json row = of_measure.row(i);
    const auto run = row.at("run").get<std::size_t>();
    const auto number = row.at("level").get<std::size_t>();
    LevelFacts& level = runs.at(run).levels.at(number);
    std::shared_ptr<LevelScores>& scores = found[{run, number}];
    if (!scores) {
      scores = level.scores ? std::make_shared<LevelScores>(*level.scores) : std::make_shared<LevelScores>();
      level.scores = scores;
    }
    const Efficiency set = read_set(row);
    for (const SetPlace& place : set_places) {
      if (row.at("space") != place.space || row.at("path") != place.path) continue;
      std::optional<Scores>& to = (*scores).*place.scores;
      if (!to) to.emplace();
      for (const auto& [role, of] : set_roles) {
        if (row.at("role") == role) (*to).*of = set;
      }
    }
  }
  for (const auto& [at, scores] : found) {
    if (at.second != 0) continue;
    scores->own = scores->root;
    scores->own_cross = scores->root_cross;
  }
}

Json pooled(const PooledScores& pooled) {
  return {{"problem", pooled.problem},
          {"strategy", pooled.strategy},
          {"key", pooled.key},
          {"seeds", pooled.seeds},
          {"targets", pooled.targets},
          {"tree", measured_set(&pooled.scores.tree)},
          {"expansion", measured_set(&pooled.scores.expansion)}};
}

Json resolves(const Resolves& resolves) { return json_of(resolves); }

Json run(const RunFacts& run) {
  Json out = json_of(run);
  if (run.conflicts.empty()) out.erase("conflicts");
  Json& law = out["bounded_loss"];
  if (law.is_object()) law["won"] = !run.solved ? "none" : run.bounded.unguided_won ? "unguided" : "guided";
  return out;
}

RunFacts read_run(const Json& json) {
  RunFacts run;
  run.cpu_seconds = run.length = run.clearance = std::numeric_limits<double>::quiet_NaN();
  read(json, run);
  for (const char* name : {"problem", "strategy", "seed", "solved", "validity_checks"})
    static_cast<void>(json.at(name));
  return run;
}

std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string lines(const Json::array_t& entries) {
  std::string out = "[";
  for (std::size_t i = 0; i < entries.size(); ++i) out += (i == 0 ? "\n  " : ",\n  ") + dump(entries[i]);
  return out + (entries.empty() ? "]" : "\n ]");
}

}  // namespace trellis::json
