// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/readers.hpp>

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>
#include <utility>

#include <trellis/scene/reader_formats.hpp>

namespace trellis {

SourceText SourceText::load(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw Error(fmt::format("{}: the file cannot be opened", path));
  SourceText text{path, {}};
  std::string line;
  while (std::getline(in, line)) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    text.lines.push_back(line);
  }
  // Opening a directory succeeds; reading from it does not.
  if (in.bad() || (text.lines.empty() && !in.eof())) throw Error(fmt::format("{}: the file cannot be read", path));
  return text;
}

Error SourceText::error(std::size_t line, const std::string& fault) const {
  return Error(fmt::format("{}:{}: {}", path, line, fault));
}

std::string SourceText::joined() const {
  std::string all;
  for (const auto& line : lines) all += line + '\n';
  return all;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  return {std::istream_iterator<std::string>(in), {}};
}

Problem problem_in(std::string name, std::shared_ptr<const Scene> scene, const ReadOptions& options) {
  Problem problem;
  problem.name = std::move(name);
  problem.space =
      default_space(scene->robot, scene->world, options.weight == 0.0 ? 1.0 / std::numbers::pi : options.weight);
  problem.scene = std::move(scene);
  problem.resolution = options.resolution;
  problem.collision = options.collision;
  return problem;
}

std::vector<Problem> read_problems(const std::string& path, const ReadOptions& options) {
  if (!std::isfinite(options.weight) || options.weight < 0.0) {
    throw Error(
        fmt::format("reading {}: weight must be greater than 0 (or 0 for the default), got {}", path, options.weight));
  }
  if (!std::isfinite(options.resolution) || options.resolution <= 0.0) {
    throw Error(fmt::format("reading {}: resolution must be greater than 0, got {}", path, options.resolution));
  }
  if (!std::isfinite(options.goal_tolerance) || options.goal_tolerance <= 0.0) {
    throw Error(fmt::format("reading {}: goal_tolerance must be greater than 0, got {}", path, options.goal_tolerance));
  }
  if (is_image(path)) return read_image(path, options);
  const SourceText text = SourceText::load(path);
  if (is_circle_world(text)) return read_circle_world(text, options);
  if (is_sbpl_arm(text)) return read_sbpl_arm(text, options);
  return read_dynobench(text, options);
}

}  // namespace trellis
