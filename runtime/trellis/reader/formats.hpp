// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/base/errors.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/planar/world.hpp>

namespace trellis {

// Functions that the readers of the formats share; callers use read_scene.

inline constexpr std::size_t most_file_bytes = std::size_t{64} << 20U;
inline constexpr std::size_t most_file_lines = 2'000'000;
inline constexpr std::size_t most_grid_side = 4096;                  ///< columns or rows of a grid or image
inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  ///< of UTF-8, with which some editors begin a file

/// \throws Error unless the file is there, regular, and not too large
void require_readable(const std::string& path);

/// The text of a file in memory, with its name in messages.
struct SourceText {
  std::string path;
  std::vector<std::string> lines;

  /// Reads a file without the byte order mark of UTF-8. \throws Error where it cannot read the file.
  static SourceText load(const std::string& path);
  /// Returns an Error at a line (counted from 1).
  [[nodiscard]] Error error(std::size_t line, const std::string& fault) const;
  [[nodiscard]] std::string joined() const;
  /// The number of lines, at least 1: where something is missing at the end.
  [[nodiscard]] std::size_t last() const { return lines.empty() ? 1 : lines.size(); }
};

/// Collects the mistakes of a table's rows, and stops at the fiftieth.
class RowErrors {
 public:
  void attempt(const std::function<void()>& read) {
    if (!errors_.attempt(read) && ++count_ == most) errors_.raise();
  }
  void add(const Error& error) {
    attempt([&] { throw Error(error); });
  }
  void raise() const { errors_.raise(); }

 private:
  static constexpr int most = 50;
  ErrorList errors_;
  int count_ = 0;
};

/// Whether some line has a key of YAML or JSON: the word, in quotes or not, and a colon.
bool has_key(const SourceText& text, std::string_view key);

/// Splits a line into words separated by blanks.
std::vector<std::string> words_of(const std::string& line);
/// Splits a line at commas.
std::vector<std::string> cells_of(const std::string& line);
/// Returns a finite number; \throws Error that names `what` it is.
double number_in(const SourceText& text, std::size_t line, const std::string& word, const char* what);
/// Returns a whole number of at least 0, at most 1e9.
std::size_t count_in(const SourceText& text, std::size_t line, const std::string& word, const char* what);

/// Returns the first bytes of a file, fewer where it is shorter.
std::string first_bytes(const std::string& path);

/// Returns a problem in the robot's default space, without start and goal.
Problem problem_in(std::string name, std::shared_ptr<const Scene> scene, const ReadOptions& options);

/// The name of a file without folder and extension.
std::string stem_of(const std::string& path);

/// Returns the occupied cells of a grid as rectangles: consecutive rows with an equal run of occupied cells form one
/// box.
/// \param path  of the file, in messages
/// \param occupied  for a column and a row, counted from the top
/// \param origin  of the lower left corner
/// \param side  of a cell, metres
/// \throws Error for too many boxes
std::vector<Obstacle> boxes_of(const std::string& path, std::size_t columns, std::size_t rows,
                               const std::function<bool(std::size_t, std::size_t)>& occupied, Vec2 origin, double side);

bool is_moving_ai_map(const SourceText& text);
SceneFile read_moving_ai_map(const SourceText& text, const ReadOptions& options);
bool is_moving_ai_queries(const SourceText& text);
SceneFile read_moving_ai_queries(const SourceText& text, const ReadOptions& options);

bool is_barn(const SourceText& text);
SceneFile read_barn(const SourceText& text, const ReadOptions& options);

bool is_svg(const SourceText& text);
SceneFile read_svg(const SourceText& text, const ReadOptions& options);

/// Whether the text is YAML with keys of a planning scene of MoveIt.
bool is_moveit_scene(const SourceText& text);
/// Whether the text is a planning scene of MoveIt as RViz exports it: a name, and objects that begin with a star.
bool is_moveit_text(const SourceText& text);
/// Reads both formats. \throws Error where the options have no robot and do not describe the file alone
SceneFile read_moveit_scene(const SourceText& text, const ReadOptions& options);
/// Whether the text is YAML with the key `image`, and with `resolution` or `occupied_thresh`.
bool is_ros_map(const SourceText& text);
SceneFile read_ros_map(const SourceText& text, const ReadOptions& options);

/// Whether the second line is the heading "x y r".
bool is_circle_world(const SourceText& text);
SceneFile read_circle_world(const SourceText& text, const ReadOptions& options);

/// Reads a world from an image: pixels of 0.05 m; dark pixels and pixels that are not opaque are obstacles. The robot
/// is a point; start and goal are the lower left and the upper right corner.
SceneFile read_image(const std::string& path, const ReadOptions& options);

/// Whether the file is a planar arm of SBPL: its first line gives the size of the environment, a later one the links.
bool is_sbpl_arm(const SourceText& text);
SceneFile read_sbpl_arm(const SourceText& text, const ReadOptions& options);

/// Whether the text has the keys of a scenario of FibrationTrees: `robots` and `problem`, and no `environment`.
bool is_fibration_trees(const SourceText& text);
/// Reads teams of discs on a floor. \throws Error for other robots and obstacles
SceneFile read_fibration_trees(const SourceText& text, const ReadOptions& options);

/// Whether the text has the keys of a scene of dynobench: `environment` and `robots`.
bool is_dynobench(const SourceText& text);
/// \throws Error also where the text is not YAML.
SceneFile read_dynobench(const SourceText& text, const ReadOptions& options);

}  // namespace trellis
