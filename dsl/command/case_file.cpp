// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/case_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/tools/session.hpp>
#include <dsl/language/words/modules.hpp>
#include <dsl/language/words/problem.hpp>
#include <trellis/base/error.hpp>
#include <trellis/base/errors.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/strategy/scale.hpp>

namespace trellis::command {

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr std::int64_t most_dimensions = 100;
constexpr std::size_t width_of_rotation = 4;
constexpr double most_coordinate = 1e9;  // metres of the metric
constexpr std::size_t most_of_path = 10000;
constexpr double most_parts_of_path = 20000.0;

std::string joined(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

std::string describe(const Json& value) {
  constexpr std::size_t longest = 60;
  if (value.is_null()) return "null";
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() <= longest) return text;
  text.resize(longest);
  return text + "...";
}

/// Returns "3:17", the line and column of a byte (from 1) in a text.
std::string place_of(const std::string& text, std::size_t byte) {
  const std::string_view before = std::string_view(text).substr(0, byte > 0 ? byte - 1 : 0);
  const std::size_t line_begin = before.rfind('\n') + 1;  // 0 on the first line
  return fmt::format("{}:{}", std::count(before.begin(), before.end(), '\n') + 1, before.size() - line_begin + 1);
}

/// Returns the part of a parser's exception message behind the first `mark`.
std::string_view behind(const Json::exception& error, std::string_view mark) {
  const std::string_view text = error.what();
  const auto at = text.find(mark);
  return at != std::string_view::npos ? text.substr(at + mark.size()) : text;
}

class Reader {
 public:
  /// \param samples  whether the case names a file of samples
  Reader(std::string file, fs::path folder, bool samples, dsl::SessionOptions scripts)
      : file_(std::move(file)), folder_(std::move(folder)), samples_(samples), scripts_(std::move(scripts)) {}

  Case read(const std::string& bytes) {
    ErrorList errors;
    parse(bytes, errors);
    Case result;
    result.file = file_;
    const bool space = errors.attempt([&] { read_space(result); });
    const bool path = space && errors.attempt([&] { read_path(result); });
    errors.attempt([&] {
      const Json& delta = required("delta", "a number greater than 0 (metres of the metric)");
      if (!delta.is_number() || !(delta.get<double>() > 0.0) || !std::isfinite(delta.get<double>())) reject("delta");
      result.tube.delta = delta.get<double>();
      if (space) check_scale(result);
      if (path) check_length(result);
    });
    errors.attempt([&] {
      result.samples = samples_ ? (folder_ / text("samples", "the name of a CSV file")).string() : file_ + ": samples";
    });
    errors.attempt([&] {
      if (!has("free")) return;
      result.free = text("free", "a scene of the standard library, a scene file, or a Lua script");
      if (space) result.valid = validity(result);
    });
    result.tube.support = result.valid ? TubeSettings::Support::free : TubeSettings::Support::all;
    errors.attempt([&] {
      const Json* seed = find("seed", "an integer of at least 0");
      if (seed == nullptr) return;
      if (!seed->is_number_unsigned()) reject("seed");
      result.seed = seed->get<std::uint64_t>();
    });
    errors.raise();
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(fmt::format("{}: {}", file_, what)); }

  void parse(const std::string& bytes, ErrorList& errors) {
    std::vector<std::string> seen;
    const Json::parser_callback_t watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
      if (event != Json::parse_event_t::key || depth != 1) return true;
      const auto key = parsed.get<std::string>();
      if (std::find(seen.begin(), seen.end(), key) != seen.end()) fail(fmt::format("the key '{}' is there twice", key));
      seen.push_back(key);
      return true;
    };
    if (bytes.find_first_not_of(" \t\r\n") == std::string::npos) fail("the file is empty; expected a JSON object");
    try {
      document_ = Json::parse(bytes, watch);
    } catch (const Json::parse_error& error) {
      // "[json.exception.parse_error.101] parse error at line 3, column 5: syntax error while ..."
      throw Error(fmt::format("{}:{}: this is not JSON: {}", file_, place_of(bytes, error.byte), behind(error, ": ")));
    } catch (const Json::out_of_range& error) {
      // "[json.exception.out_of_range.406] number overflow parsing '1e999'"
      std::string what(behind(error, "] "));
      const auto begin = what.find('\'');
      const auto at =
          begin != std::string::npos ? bytes.find(what.substr(begin + 1, what.size() - begin - 2)) : std::string::npos;
      if (at != std::string::npos) what += fmt::format(" at {}", place_of(bytes, at + 1));
      fail(what);
    }
    if (!document_.is_object()) fail(fmt::format("a case must be a JSON object, got {}", describe(document_)));
    static const std::vector<std::string> known = {"dim",  "coords", "weights", "lo",   "hi",   "periodic", "rotations",
                                                   "path", "delta",  "samples", "free", "seed", "distance"};
    for (const auto& [key, value] : document_.items()) {
      const bool unused = !samples_ && key == "samples";
      if (!unused && std::find(known.begin(), known.end(), key) != known.end()) continue;
      errors.attempt([&, &name = key] {
        fail(fmt::format("unknown key '{}'{}; the keys are: {}", name, did_you_mean(name, known), joined(known)));
      });
    }
  }

  [[nodiscard]] bool has(const char* key) const { return document_.contains(key); }
  /// Returns the value of a key; `reject` uses `expects` in its message.
  const Json* find(const char* key, std::string expects) {
    expects_ = std::move(expects);
    const auto it = document_.find(key);
    return it != document_.end() ? &*it : nullptr;
  }
  const Json& required(const char* key, std::string expects) {
    const Json* value = find(key, std::move(expects));
    if (value == nullptr) fail(fmt::format("the key '{}' is missing: {}", key, expects_));
    return *value;
  }
  [[noreturn]] void reject(const char* key) const {
    fail(fmt::format("{} must be {}, got {}", key, expects_, describe(document_.at(key))));
  }

  std::string text(const char* key, std::string expects) {
    const Json& value = required(key, std::move(expects));
    if (!value.is_string() || value.get<std::string>().empty()) reject(key);
    return value.get<std::string>();
  }

  /// A list with an entry for each coordinate.
  const Json& list(const char* key, const std::string& entries, std::size_t dimension) {
    const Json& value = required(key, fmt::format("a list of {} {}", dimension, entries));
    if (!value.is_array()) reject(key);
    if (value.size() != dimension) {
      fail(fmt::format("{} must be a list of {} {} (dim), got {}: {}", key, dimension, entries, value.size(),
                       describe(value)));
    }
    return value;
  }
  std::vector<double> numbers(const char* key, std::size_t dimension) {
    const Json& value = list(key, "numbers", dimension);
    std::vector<double> result;
    for (const Json& entry : value) {
      if (!entry.is_number() || !std::isfinite(entry.get<double>())) {
        fail(fmt::format("{} must hold finite numbers, got {} as number {}", key, describe(entry), result.size() + 1));
      }
      result.push_back(entry.get<double>());
    }
    return result;
  }

  void read_space(Case& result) {
    const Json& dim = required("dim", fmt::format("the number of coordinates, an integer in [1, {}]", most_dimensions));
    if (!dim.is_number_integer() || dim < 1 || dim > most_dimensions) reject("dim");
    const auto dimension = dim.get<std::size_t>();
    ErrorList errors;
    std::vector<std::string> names;
    errors.attempt([&] { names = coordinates(dimension); });
    std::vector<double> weights, lo, hi;
    errors.attempt([&] { weights = numbers("weights", dimension); });
    errors.attempt([&] { lo = numbers("lo", dimension); });
    errors.attempt([&] { hi = numbers("hi", dimension); });
    std::vector<bool> periodic;
    errors.attempt([&] { periodic = wrapping(dimension); });
    errors.raise();
    std::vector<Axis> axes;
    for (std::size_t j = 0; j < dimension; ++j) {
      errors.attempt([&] {
        if (weights[j] > 0.0) return;
        fail(fmt::format("weights must be greater than 0 (metres of the metric per unit), got {:g} for {}", weights[j],
                         names[j]));
      });
      errors.attempt([&] {
        if (lo[j] < hi[j]) return;
        fail(fmt::format("lo must be below hi, got lo = {:g} and hi = {:g} for {}", lo[j], hi[j], names[j]));
      });
      errors.attempt([&] {
        const double farthest = weights[j] * std::max(std::abs(lo[j]), std::abs(hi[j]));
        if (farthest <= most_coordinate) return;
        fail(fmt::format("lo, hi and weights must keep {} within {:g} m of 0 in the metric, got {:g} m", names[j],
                         most_coordinate, farthest));
      });
      axes.push_back({names[j], lo[j], hi[j], weights[j], periodic[j]});
    }
    errors.raise();
    std::vector<std::size_t> rotations;
    errors.attempt([&] { rotations = read_rotations(axes); });
    errors.raise();
    result.space = space_of(axes, rotations);
    result.coordinates = names;
    read_distance(result, names);
  }

  /// The rule of scale, of scripts too.
  void check_scale(const Case& result) const {
    const double extent = result.space.diameter();
    if (result.tube.delta * most_parts >= extent) return;
    fail(
        fmt::format("delta is {:g} m, which divides the {:.3g} m of the space into more than {:g} parts; expected at "
                    "least {:.3g}",
                    result.tube.delta, extent, most_parts, extent / most_parts));
  }

  /// The memory and time of a target grow with the number of its radius along the path.
  void check_length(const Case& result) const {
    const double length = path_length(result.space, result.path);
    if (length <= most_parts_of_path * result.tube.delta) return;
    fail(
        fmt::format("path is {:.4g} m long, {:.0f} times delta; expected at most {:g} times: shorten it, or choose a "
                    "larger delta",
                    length, length / result.tube.delta, most_parts_of_path));
  }

  /// Returns the first column of each rotation.
  std::vector<std::size_t> read_rotations(const std::vector<Axis>& axes) {
    std::vector<std::size_t> first;
    const Json* value =
        find("rotations", "a list of rotations, each the names of four coordinates: a quaternion x, y, z, w");
    if (value == nullptr) return first;
    if (!value->is_array()) reject("rotations");
    for (const Json& rotation : *value) {
      if (!rotation.is_array() || rotation.size() != width_of_rotation) reject("rotations");
      std::size_t at = 0;
      while (at < axes.size() && rotation[0] != axes[at].name) ++at;
      for (std::size_t k = 0; k < width_of_rotation; ++k) {
        if (at + k >= axes.size() || rotation[k] != axes[at + k].name) {
          fail(fmt::format("rotations: {} must be four neighbouring coordinates of coords, in their order",
                           describe(rotation)));
        }
        const Axis& axis = axes[at + k];
        if (axis.periodic) fail(fmt::format("rotations: {} cannot be periodic", axis.name));
        if (axis.weight != axes[at].weight) {
          fail(fmt::format("rotations: {} needs one weight, metres per radian, for its four coordinates",
                           describe(rotation)));
        }
      }
      first.push_back(at);
    }
    return first;
  }

  /// Returns the product of the axes and the rotations at their columns.
  static Space space_of(const std::vector<Axis>& axes, const std::vector<std::size_t>& rotations) {
    std::vector<std::pair<double, Space>> factors;
    std::vector<Axis> line;
    const auto add_line = [&] {
      std::vector<std::string> names;
      names.reserve(line.size());
      for (const Axis& axis : line) names.push_back(axis.name);
      if (!line.empty()) factors.emplace_back(1.0, Space(fmt::format("({})", joined(names)), std::exchange(line, {})));
    };
    for (std::size_t j = 0; j < axes.size();) {
      if (std::find(rotations.begin(), rotations.end(), j) == rotations.end()) {
        line.push_back(axes[j++]);
        continue;
      }
      add_line();
      factors.emplace_back(1.0, Space::so3(axes[j].weight, axes[j].name));
      j += width_of_rotation;
    }
    add_line();
    return factors.size() == 1 ? factors.front().second : Space::product(factors);
  }

  std::vector<std::string> coordinates(std::size_t dimension) {
    std::vector<std::string> names;
    for (const Json& name : list("coords", "names", dimension)) {
      const bool good = name.is_string() && !name.get<std::string>().empty() &&
                        name.get<std::string>().find_first_of(",\"\r\n") == std::string::npos;
      if (!good) {
        fail(fmt::format("coords must hold names without commas and quotes, got {} as number {}", describe(name),
                         names.size() + 1));
      }
      names.push_back(name.get<std::string>());
      if (std::find(names.begin(), names.end() - 1, names.back()) != names.end() - 1) {
        fail(fmt::format("coords holds '{}' twice", names.back()));
      }
    }
    return names;
  }

  std::vector<bool> wrapping(std::size_t dimension) {
    std::vector<bool> periodic;
    for (const Json& entry : list("periodic", "booleans, true where the coordinate wraps from hi to lo", dimension)) {
      if (!entry.is_boolean()) {
        fail(fmt::format("periodic must hold booleans, got {} as number {}", describe(entry), periodic.size() + 1));
      }
      periodic.push_back(entry.get<bool>());
    }
    return periodic;
  }

  void read_distance(Case& result, const std::vector<std::string>& names) {
    const std::size_t dimension = names.size();
    const Json* distance = find("distance", R"("planar" or "full")");
    result.tube.distance = TubeSettings::Distance::full;
    if (distance == nullptr) return;
    if (*distance != "planar" && *distance != "full") reject("distance");
    if (*distance == "full") return;
    result.tube.distance = TubeSettings::Distance::planar;
    if (dimension < 2) fail(R"(distance "planar" needs two coordinates of a position, and dim is 1; write "full")");
    const auto x = std::find(names.begin(), names.end(), "x");
    const auto y = std::find(names.begin(), names.end(), "y");
    const bool named = x != names.end() && y != names.end();
    result.position = {named ? static_cast<std::size_t>(x - names.begin()) : 0,
                       named ? static_cast<std::size_t>(y - names.begin()) : 1};
    // A body in space has a position of three coordinates.
    const auto z = std::find(names.begin(), names.end(), "z");
    if (!result.space.flat() && named && z != names.end()) {
      result.position.push_back(static_cast<std::size_t>(z - names.begin()));
    }
  }

  void read_path(Case& result) {
    const Space& space = result.space;
    const std::size_t dimension = space.dimension();
    const Json& path = required("path", "a list of configurations, start to goal, two at least");
    if (!path.is_array()) reject("path");
    if (path.size() < 2) {
      fail(fmt::format("path must hold two configurations at least, got {}", path.size()));
    }
    if (path.size() > most_of_path) {
      fail(fmt::format("path must hold {} configurations at most, got {}: shorten it, the target lies about it",
                       most_of_path, path.size()));
    }
    result.path = Configurations(dimension);
    ErrorList errors;
    for (std::size_t i = 0; i < path.size(); ++i) {
      errors.attempt([&] { result.path.push(configuration(path, i, space)); });
    }
    errors.raise();
    if (!has_length(result)) {
      fail(fmt::format("path has no length{}: a tube needs two configurations that differ",
                       result.tube.distance == TubeSettings::Distance::planar ? " in the position" : ""));
    }
  }

  [[nodiscard]] Configuration configuration(const Json& path, std::size_t i, const Space& space) const {
    const std::size_t dimension = space.dimension();
    Configuration q;
    const auto wrong = [&](const std::string& what) {
      fail(fmt::format("path: configuration {} of {} {}", i + 1, path.size(), what));
    };
    if (!path[i].is_array() || path[i].size() != dimension) {
      wrong(fmt::format("must be a list of {} numbers {}, got {}", dimension, space.name(), describe(path[i])));
    }
    for (const Json& coordinate : path[i]) {
      if (!coordinate.is_number() || !std::isfinite(coordinate.get<double>())) {
        wrong(fmt::format("must hold finite numbers, got {}", describe(coordinate)));
      }
      q.push_back(coordinate.get<double>());
    }
    if (!normalise_rotations(space, q)) wrong("has a quaternion of a norm that is not 1");
    const std::vector<Axis> axes = space.coordinates();
    for (std::size_t j = 0; j < dimension; ++j) {
      const Axis& axis = axes[j];
      if (axis.periodic || (q[j] >= axis.lo && q[j] <= axis.hi)) continue;
      wrong(fmt::format("lies outside of the space: {} = {:g} is not in [{:g}, {:g}]", axis.name, q[j], axis.lo,
                        axis.hi));
    }
    return q;
  }

  static bool has_length(const Case& c) {
    Configuration step(c.space.dimension());
    for (std::size_t i = 0; i + 1 < c.path.size(); ++i) {
      if (c.space.flat()) {
        c.space.difference(c.path[i], c.path[i + 1], step);
      } else {
        for (std::size_t j = 0; j < step.size(); ++j) step[j] = c.path[i + 1][j] - c.path[i][j];
      }
      for (std::size_t j = 0; j < step.size(); ++j) {
        const bool counts =
            c.position.empty() || std::find(c.position.begin(), c.position.end(), j) != c.position.end();
        if (counts && step[j] != 0.0) return true;
      }
    }
    return false;
  }

  // What is valid
  // --------------------------------------------------------------------------------------------------------

  [[nodiscard]] std::vector<Problem> problems(const std::string& free) const {
    const std::string folder = folder_.string();
    if (free.ends_with(".lua")) {
      const std::string script = (folder_ / free).string();
      dsl::Session session(fs::path(script).parent_path().string(), scripts_);
      return session.problems(dsl::without_shebang(dsl::read_file(script)), script);
    }
    const bool name =
        std::all_of(free.begin(), free.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
    if (name) {
      dsl::Session session(folder);
      auto there = session.evaluate(
          "local names = {} for name in pairs(scenes) do if name ~= 'load' and name ~= 'exists' and name ~= 'robot' "
          "then names[#names + 1] = name end end table.sort(names) return table.unpack(names)",
          "free");
      if (std::find(there.begin(), there.end(), free) == there.end()) {
        throw Error(fmt::format(
            "no scene is called '{}'{}; there are: {}; a scene file has a name with an ending, and so has a "
            "Lua script (.lua)",
            free, did_you_mean(free, there), joined(there)));
      }
      try {
        return session.problems(fmt::format("return scenes['{}']()", free), "free");
      } catch (const Error& error) {
        std::string why = error.what();
        constexpr std::string_view place = "free:1: ";
        if (why.starts_with(place)) why.erase(0, place.size());
        throw Error(why + "; a scene file has a name with an ending, and so has a Lua script (.lua)");
      }
    }
    const std::string path = dsl::find_scene(free, folder);
    if (path.empty()) throw Error(dsl::missing_scene(free, folder));
    return read_problems(path, {});
  }

  [[nodiscard]] Target::Valid validity(const Case& c) const {
    std::vector<Problem> found;
    try {
      found = problems(c.free);
    } catch (const Error& error) {
      fail(fmt::format("free: {}", error.what()));
    }
    const Problem& problem = found.front();
    for (const Problem& other : found) {
      const bool same =
          other.scene->world_identity() == problem.scene->world_identity() && other.space == problem.space;
      if (!same) {
        fail(fmt::format(
            "free: '{}' holds {} problems in different worlds; name a Lua script that returns the one meant", c.free,
            found.size()));
      }
    }
    const std::vector<Axis> axes = problem.space.coordinates();
    std::vector<std::string> names;
    names.reserve(axes.size());
    for (const Axis& axis : axes) names.push_back(axis.name);
    if (axes.size() != c.space.dimension()) {
      fail(fmt::format("free: a configuration of '{}' has {} coordinates ({}), one of the case has {} {}", problem.name,
                       axes.size(), joined(names), c.space.dimension(), c.space.name()));
    }
    for (std::size_t j = 0; j < axes.size(); ++j) {
      const std::string& name = c.coordinates[j];
      const auto there = std::find(names.begin(), names.end(), name);
      if (there == names.end() || there == names.begin() + static_cast<std::ptrdiff_t>(j)) continue;
      fail(fmt::format("free: the coordinates of '{}' are in another order: ({}), those of the case are {}",
                       problem.name, joined(names), c.space.name()));
    }
    const std::shared_ptr<Instance> instance = make_instance(problem);
    return [instance](View q) { return instance->validity->state(q); };
  }

  std::string file_;
  fs::path folder_;
  bool samples_;
  dsl::SessionOptions scripts_;
  Json document_;
  std::string expects_;  // of the most recently read key
};

}  // namespace

bool normalise_rotations(const Space& space, MutableView q) {
  if (space.flat()) return true;
  constexpr double accuracy = 0.01;
  for (const Factor& factor : space.factors()) {
    if (factor.kind != Factor::Kind::rotation) continue;
    double square = 0.0;
    for (std::size_t k = 0; k < factor.width(); ++k) square += q[factor.column + k] * q[factor.column + k];
    if (!(std::abs(std::sqrt(square) - 1.0) <= accuracy)) return false;
  }
  space.normalise(q);
  return true;
}

Case read_case(const std::string& file, const dsl::SessionOptions& scripts) {
  return Reader(file, fs::path(file).parent_path(), true, scripts).read(dsl::read_file(file));
}

Case read_case_text(const std::string& text, const std::string& name, const std::string& folder,
                    const dsl::SessionOptions& scripts) {
  return Reader(name, folder, false, scripts).read(text);
}

}  // namespace trellis::command
