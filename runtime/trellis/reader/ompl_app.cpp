// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_formats.hpp>
#include <trellis/reader/spatial_formats.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

struct Entry {
  std::string value;
  std::size_t line = 0;
};

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

const std::vector<std::string>& known_keys() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> all{"name",         "world",   "robot",           "objective", "objective.threshold",
                                 "threshold",    "sampler", "solution_length", "control",   "statespace",
                                 "turningradius"};
    for (const char* end : {"start", "goal"}) {
      for (const char* key : {"x", "y", "z", "axis.x", "axis.y", "axis.z", "theta"}) {
        all.push_back(fmt::format("{}.{}", end, key));
      }
    }
    for (const char* side : {"min", "max"}) {
      for (const char* axis : {"x", "y", "z"}) all.push_back(fmt::format("volume.{}.{}", side, axis));
    }
    return all;
  }();
  return keys;
}

/// The section [problem] of a configuration.
class Configured {
 public:
  explicit Configured(const SourceText& source) : source_(source) {
    std::string section;
    for (std::size_t line = 1; line <= source_.lines.size(); ++line) {
      std::string_view text = source_.lines[line - 1];
      text = trimmed(text.substr(0, text.find('#')));
      if (text.empty()) continue;
      if (text.front() == '[') {
        section = text.substr(1, text.find(']') - 1);
        // How planners run is no part of a problem.
        if (section != "problem" && section != "benchmark" && section != "planner") {
          throw source_.error(line,
                              fmt::format("expected [problem], [benchmark] or [planner], got {}", in_quotes(text)));
        }
        continue;
      }
      if (section == "problem") add(text, line);
    }
  }

  [[nodiscard]] const Entry& at(const std::string& key) const {
    const auto entry = entries_.find(key);
    if (entry == entries_.end()) throw source_.error(last(), fmt::format("'{}' is missing in [problem]", key));
    return entry->second;
  }
  [[nodiscard]] const Entry* find(const std::string& key) const {
    const auto entry = entries_.find(key);
    return entry == entries_.end() ? nullptr : &entry->second;
  }
  [[nodiscard]] double number(const std::string& key) const {
    const Entry& entry = at(key);
    const auto value = number_in(entry.value);
    if (!value || !std::isfinite(*value)) {
      throw source_.error(entry.line, fmt::format("'{}' needs a number, got {}", key, in_quotes(entry.value)));
    }
    return *value;
  }
  [[nodiscard]] Vec3 vector(const std::string& key) const {
    return {number(key + ".x"), number(key + ".y"), number(key + ".z")};
  }
  [[nodiscard]] Error error(std::size_t line, const std::string& fault) const { return source_.error(line, fault); }

 private:
  [[nodiscard]] std::size_t last() const { return std::max<std::size_t>(source_.lines.size(), 1); }
  void add(std::string_view text, std::size_t line) {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) {
      throw source_.error(line, fmt::format("expected KEY = VALUE, got {}", in_quotes(text)));
    }
    const std::string key(trimmed(text.substr(0, equals)));
    const auto& known = known_keys();
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw source_.error(line, fmt::format("unknown key {} in [problem]{}", in_quotes(key), did_you_mean(key, known)));
    }
    const auto [entry, fresh] = entries_.emplace(key, Entry{std::string(trimmed(text.substr(equals + 1))), line});
    if (!fresh) throw source_.error(line, fmt::format("'{}' a second time, after line {}", key, entry->second.line));
  }

  const SourceText& source_;
  std::map<std::string, Entry> entries_;
};

Pose3 pose_of(const Configured& config, const std::string& end) {
  const Vec3 axis = config.vector(end + ".axis");
  const double angle = config.number(end + ".theta");
  const double length = norm(axis);
  if (length == 0.0 && angle != 0.0) {
    throw config.error(config.at(end + ".axis.x").line,
                       fmt::format("the axis of the turn of the {} has length 0", end));
  }
  return {config.vector(end), length == 0.0 ? Quaternion{} : rotation_of(angle / length * axis)};
}

/// Refuses what a rigid body in space does not have.
void check_kind(const Configured& config) {
  if (const Entry* control = config.find("control")) {
    throw config.error(control->line, "problems with controls are not read, only rigid bodies");
  }
  for (const char* key : {"statespace", "turningradius"}) {
    if (const Entry* entry = config.find(key)) {
      throw config.error(entry->line,
                         fmt::format("'{}' is of robots in the plane; only rigid bodies in space are read", key));
    }
  }
  if (config.find("start.z") == nullptr) {
    throw config.error(config.at("start.x").line,
                       "without start.z the robot moves in the plane; only rigid bodies in space are read");
  }
}

}  // namespace

bool is_ompl_app(const SourceText& text) {
  return std::any_of(text.lines.begin(), text.lines.end(),
                     [](std::string_view line) { return trimmed(line.substr(0, line.find('#'))) == "[problem]"; });
}

SceneFile read_ompl_app(const SourceText& text, const ReadOptions& options) {
  const Configured config(text);
  check_kind(config);
  SceneFile file;
  file.format = "configuration of OMPL.app";
  file.units = "1 unit = 1 m; angles in radians";
  file.frame = "the robot's mesh is about the mean of its vertices";
  MeshFolder meshes(text.path);
  const Entry& robot_file = config.at("robot");
  const Entry& world_file = config.at("world");
  for (const Entry* entry : {&robot_file, &world_file}) meshes.need(entry->value, entry->line);
  // OMPL.app loads meshes through assimp.
  meshes.load({.y_up = true}, file.warnings);
  const MeshFile& body = meshes.at(robot_file.value);
  for (const MeshFile* mesh : {&body, &meshes.at(world_file.value)}) {
    if (mesh->up == 'x' || mesh->up == 'z') {
      file.notes.push_back(fmt::format("{} is COLLADA with {} up, turned as by OMPL.app: (x, y, z) is ({})",
                                       mesh == &body ? robot_file.value : world_file.value, mesh->up,
                                       mesh->up == 'x' ? "-y, x, z" : "x, z, -y"));
    }
  }
  const Robot3 robot(robot_file.value, {{body.mesh, {-1.0 * body.vertex_mean, {}}}});
  // OMPL.app bounds the reference point, and meshes are surfaces to it.
  World3 world({config.vector("volume.min"), config.vector("volume.max")},
               {{fmt::format("obstacle 1 ({})", world_file.value), {meshes.at(world_file.value).mesh, {}}}},
               Contain::reference, true);
  const Entry* name = config.find("name");
  Problem problem = spatial_problem(name != nullptr ? name->value : fs::path(text.path).stem().string(),
                                    std::move(world), robot, options);
  problem.start = configuration_of(robot, pose_of(config, "start"));
  problem.goals = {configuration_of(robot, pose_of(config, "goal"))};
  file.problems.push_back(std::move(problem));
  return file;
}

}  // namespace trellis
