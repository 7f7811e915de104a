// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <system_error>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/reader/spatial_formats.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

}  // namespace

std::string beside(const std::string& file, const std::string& name) {
  const fs::path path = fs::path(file).parent_path() / name;
  std::error_code ignored;
  if (fs::exists(path, ignored)) return path.string();
  for (const auto& entry : fs::directory_iterator(path.has_parent_path() ? path.parent_path() : ".", ignored)) {
    if (lower(entry.path().filename().string()) == lower(path.filename().string())) return entry.path().string();
  }
  return path.string();
}

void MeshFolder::need(const std::string& name, std::size_t line) { lines_.emplace(name, line); }

void MeshFolder::load(const MeshOptions& options, std::vector<std::string>& warnings) {
  std::string missing;
  std::size_t count = 0, first = 0;
  for (const auto& [name, line] : lines_) {
    std::error_code ignored;
    if (fs::exists(beside(scene_, name), ignored)) continue;
    missing += fmt::format("{}{} (line {})", count == 0 ? "" : ", ", name, line);
    first = count++ == 0 ? line : std::min(first, line);
  }
  if (count > 0) {
    throw Error(fmt::format("{}:{}: {} of the meshes that it names {} not there: {}", scene_, first, count,
                            count == 1 ? "is" : "are", missing));
  }
  for (const auto& [name, line] : lines_) {
    MeshFile file = read_mesh(beside(scene_, name), options);
    warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
    if (!file.up_warning.empty()) warnings.push_back(file.up_warning);
    files_.emplace(name, std::move(file));
  }
}

Problem spatial_problem(std::string name, World3 world, Robot3 robot, const ReadOptions& options) {
  const double radius = robot.bounding_radius();
  Problem problem;
  problem.name = std::move(name);
  problem.scene = std::make_shared<SpatialScene>(std::move(world), std::move(robot));
  const double weight = options.weight != 0.0 ? options.weight : (radius > 0.0 ? radius : 1.0);
  problem.space = problem.scene->default_space(weight);
  problem.resolution = options.resolution;
  const std::vector<std::string> backends = collision_backends(*problem.scene);
  const bool known = std::find(backends.begin(), backends.end(), options.collision) != backends.end();
  problem.collision = known ? options.collision : backends.front();
  return problem;
}

Configuration configuration_of(const Robot3& robot, const Pose3& pose) {
  const Vec3& p = pose.position;
  if (!robot.rotates()) return {p.x, p.y, p.z};
  const Quaternion q = normalised(pose.orientation);
  return {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
}

}  // namespace trellis
