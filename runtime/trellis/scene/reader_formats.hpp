// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/scene/readers.hpp>

namespace trellis {

// What the readers of the single formats share; read_problems is the way in.

/// A text file held in memory, with the name that messages call it by.
struct SourceText {
  std::string path;
  std::vector<std::string> lines;

  /// Throws Error where the file cannot be read.
  static SourceText load(const std::string& path);
  /// An Error at a line (counted from 1).
  [[nodiscard]] Error error(std::size_t line, const std::string& fault) const;
  [[nodiscard]] std::string joined() const;
};

/// Words separated by blanks.
std::vector<std::string> words_of(const std::string& line);

/// A problem in the robot's default space, without start and goal.
Problem problem_in(std::string name, std::shared_ptr<const Scene> scene, const ReadOptions& options);

/// Whether the second line is the heading "x y r".
bool is_circle_world(const SourceText& text);
std::vector<Problem> read_circle_world(const SourceText& text, const ReadOptions& options);

/// Whether it is a PNG.
bool is_image(const std::string& path);
/// A world drawn in pixels of 0.05 m, the dark ones obstacles; a point goes from the lower left corner to the upper
/// right one.
std::vector<Problem> read_image(const std::string& path, const ReadOptions& options);

/// Whether it is a planar arm of SBPL's: its first line gives the size of the environment, a later one the links.
bool is_sbpl_arm(const SourceText& text);
std::vector<Problem> read_sbpl_arm(const SourceText& text, const ReadOptions& options);

/// Throws Error as well where the text is no YAML at all.
std::vector<Problem> read_dynobench(const SourceText& text, const ReadOptions& options);

}  // namespace trellis
