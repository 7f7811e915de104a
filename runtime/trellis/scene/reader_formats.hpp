// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/scene/readers.hpp>

namespace trellis {

// Functions that the readers of the formats share; callers use read_problems.

/// The text of a file in memory, with its name in messages.
struct SourceText {
  std::string path;
  std::vector<std::string> lines;

  /// \throws Error where it cannot read the file.
  static SourceText load(const std::string& path);
  /// Returns an Error at a line (counted from 1).
  [[nodiscard]] Error error(std::size_t line, const std::string& fault) const;
  [[nodiscard]] std::string joined() const;
};

/// Splits a line into words separated by blanks.
std::vector<std::string> words_of(const std::string& line);

/// Returns a problem in the robot's default space, without start and goal.
Problem problem_in(std::string name, std::shared_ptr<const Scene> scene, const ReadOptions& options);

/// Whether the second line is the heading "x y r".
bool is_circle_world(const SourceText& text);
std::vector<Problem> read_circle_world(const SourceText& text, const ReadOptions& options);

/// Whether the file is a PNG.
bool is_image(const std::string& path);
/// Reads a world from an image: pixels of 0.05 m, dark pixels are obstacles. The robot is a point; start and goal are
/// the lower left and the upper right corner.
std::vector<Problem> read_image(const std::string& path, const ReadOptions& options);

/// Whether the file is a planar arm of SBPL: its first line gives the size of the environment, a later one the links.
bool is_sbpl_arm(const SourceText& text);
std::vector<Problem> read_sbpl_arm(const SourceText& text, const ReadOptions& options);

/// \throws Error also where the text is not YAML.
std::vector<Problem> read_dynobench(const SourceText& text, const ReadOptions& options);

}  // namespace trellis
