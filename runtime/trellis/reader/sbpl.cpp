// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <utility>

#include <trellis/base/errors.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

/// Links are lines in these files; Trellis makes them this share of a cell wide.
constexpr double link_width = 0.1;

constexpr std::array<const char*, 6> headings = {
    "environmentsize(meters):", "discretization(cells):",    "basex(cells):",
    "linklengths(meters):",     "linkstartangles(degrees):", "endeffectorgoal(cells):"};
constexpr const char* grid_heading = "environment:";

/// The file's lines, indexed by their headings, and its grid.
class ArmFile {
 public:
  explicit ArmFile(const SourceText& text) : text_(text) {
    RowErrors errors;
    std::size_t i = 0;
    for (; i < text.lines.size(); ++i) {
      auto words = words_of(text.lines[i]);
      if (words.empty()) continue;
      if (words[0] == grid_heading) break;
      const auto* const known = std::find(headings.begin(), headings.end(), words[0]);
      if (known == headings.end()) {
        errors.add(text.error(
            i + 1, fmt::format("'{}', expected one of {} or {}", words[0], fmt::join(headings, ", "), grid_heading)));
        continue;
      }
      const std::string heading = words[0];
      words.erase(words.begin());
      if (!fields_.emplace(heading, Field{i + 1, std::move(words)}).second) {
        errors.add(text.error(i + 1, fmt::format("'{}' for the second time", heading)));
      }
    }
    errors.raise();
    if (i == text.lines.size()) throw text.error(std::max<std::size_t>(i, 1), fmt::format("no '{}'", grid_heading));
    grid_line_ = i + 2;
    for (++i; i < text.lines.size(); ++i) {
      auto words = words_of(text.lines[i]);
      if (!words.empty()) grid_.push_back({i + 1, std::move(words)});
    }
  }

  /// Returns the numbers of a field; \throws Error unless there are `count` of them, where `count` is not 0.
  [[nodiscard]] std::vector<double> numbers(const char* heading, std::size_t count) const {
    const auto at = fields_.find(heading);
    if (at == fields_.end()) throw text_.error(grid_line_ - 1, fmt::format("'{}' is missing above", heading));
    const auto& [line, words] = at->second;
    if (words.empty() || (count > 0 && words.size() != count)) {
      throw text_.error(line,
                        fmt::format("{} {} number{}, expected {}", heading, words.size(), words.size() == 1 ? "" : "s",
                                    count > 0 ? fmt::format("{}", count) : std::string("one for each link")));
    }
    std::vector<double> numbers;
    numbers.reserve(words.size());
    for (const auto& word : words) {
      double value = 0.0;
      const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (fault != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
        throw text_.error(line, fmt::format("{} '{}', expected a finite number", heading, word));
      }
      numbers.push_back(value);
    }
    return numbers;
  }

  /// Returns a cell index, at least 0 and below `end`.
  [[nodiscard]] std::size_t cell(const char* heading, double value, double end) const {
    if (!(value >= 0.0) || !(value < end) || value != std::floor(value)) {
      throw text_.error(
          fields_.at(heading).line,
          fmt::format("{} {:g}, expected a whole number of at least 0 and below {:g}", heading, value, end));
    }
    return static_cast<std::size_t>(value);
  }

  /// Returns whether each cell is occupied, row by row from the top.
  [[nodiscard]] std::vector<std::vector<bool>> grid(std::size_t columns, std::size_t rows) const {
    if (grid_.size() != rows) {
      throw text_.error(grid_.empty() ? grid_line_ - 1 : grid_.back().line,
                        fmt::format("the grid has {} rows, expected {}", grid_.size(), rows));
    }
    std::vector<std::vector<bool>> taken;
    taken.reserve(rows);
    RowErrors errors;
    for (const auto& [line, words] : grid_) {
      if (words.size() != columns) {
        errors.add(text_.error(line, fmt::format("a row of {} cells, expected {}", words.size(), columns)));
        continue;
      }
      std::vector<bool> row;
      row.reserve(columns);
      for (const auto& word : words) {
        if (word != "0" && word != "1") {
          errors.add(text_.error(line, fmt::format("a cell is '{}', expected 0 or 1", word)));
        }
        row.push_back(word == "1");
      }
      taken.push_back(std::move(row));
    }
    errors.raise();
    return taken;
  }

  [[nodiscard]] Error error(const char* heading, const std::string& fault) const {
    return text_.error(fields_.at(heading).line, fault);
  }

 private:
  struct Field {
    std::size_t line;
    std::vector<std::string> words;
  };

  const SourceText& text_;
  std::map<std::string, Field> fields_;
  std::vector<Field> grid_;
  std::size_t grid_line_ = 0;  ///< the first line of the grid
};

/// Returns the occupied cells as rectangles; a sweep from the top merges cells.
std::vector<Obstacle> obstacles_of(std::vector<std::vector<bool>> taken, double width, double height) {
  std::vector<Obstacle> obstacles;
  const std::size_t rows = taken.size();
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < taken[r].size(); ++c) {
      if (!taken[r][c]) continue;
      std::size_t right = c;
      while (right < taken[r].size() && taken[r][right]) ++right;
      const auto whole = [&](std::size_t row) {
        return std::all_of(taken[row].begin() + static_cast<std::ptrdiff_t>(c),
                           taken[row].begin() + static_cast<std::ptrdiff_t>(right), [](bool cell) { return cell; });
      };
      std::size_t below = r;
      while (below < rows && whole(below)) {
        std::fill(taken[below].begin() + static_cast<std::ptrdiff_t>(c),
                  taken[below].begin() + static_cast<std::ptrdiff_t>(right), false);
        ++below;
      }
      const Box2 box{{static_cast<double>(c) * width, static_cast<double>(rows - below) * height},
                     {static_cast<double>(right) * width, static_cast<double>(rows - r) * height}};
      obstacles.push_back({fmt::format("cells {} to {} of rows {} to {}", c, right - 1, r, below - 1), box});
    }
  }
  return obstacles;
}

/// \throws Error for all fields that do not hold their numbers
void check_fields(const ArmFile& file) {
  ErrorList errors;
  std::size_t links = 0;
  errors.attempt([&] { links = file.numbers(headings[3], 0).size(); });
  for (const auto& [heading, count] : {std::pair{0, std::size_t{2}}, {1, 2}, {2, 1}, {4, links}, {5, 2}}) {
    errors.attempt(
        [&, h = heading, n = count] { static_cast<void>(file.numbers(headings[static_cast<std::size_t>(h)], n)); });
  }
  errors.raise();
}

}  // namespace

bool is_sbpl_arm(const SourceText& text) {
  return !text.lines.empty() && text.lines[0].starts_with(headings[0]) &&
         std::any_of(text.lines.begin(), text.lines.end(),
                     [](const std::string& line) { return line.starts_with("linklengths"); });
}

SceneFile read_sbpl_arm(const SourceText& text, const ReadOptions& options) {
  const ArmFile file(text);
  check_fields(file);
  const auto size = file.numbers(headings[0], 2);
  if (!(size[0] > 0.0) || !(size[1] > 0.0)) throw file.error(headings[0], "the size must be greater than 0");
  const auto cells = file.numbers(headings[1], 2);
  constexpr double most_cells = 1e4;
  const std::size_t columns = file.cell(headings[1], cells[0], most_cells);
  const std::size_t rows = file.cell(headings[1], cells[1], most_cells);
  if (columns == 0 || rows == 0) throw file.error(headings[1], "the grid has no cells");
  const double width = size[0] / cells[0];
  const double height = size[1] / cells[1];

  Arm arm;
  arm.links = file.numbers(headings[3], 0);
  arm.widths.assign(arm.links.size(), link_width * std::min(width, height));
  const double base = static_cast<double>(file.cell(headings[2], file.numbers(headings[2], 1)[0], cells[0]));
  arm.base = {(base + 0.5) * width, 0.5 * height};
  if (std::any_of(arm.links.begin(), arm.links.end(), [](double length) { return !(length > 0.0); })) {
    throw file.error(headings[3], "lengths of links must be greater than 0");
  }

  // The angles of the file refer to the world, those of Trellis to the previous link.
  const auto angles = file.numbers(headings[4], arm.links.size());
  Configuration start;
  start.reserve(angles.size());
  for (std::size_t i = 0; i < angles.size(); ++i) {
    start.push_back((angles[i] - (i > 0 ? angles[i - 1] : 0.0)) * std::numbers::pi / 180.0);
  }

  const auto goal = file.numbers(headings[5], 2);
  const auto column = static_cast<double>(file.cell(headings[5], goal[0], cells[0]));
  const auto row = static_cast<double>(file.cell(headings[5], goal[1], cells[1]));
  Reach reach;
  reach.body = arm.links.size() - 1;
  reach.point = {arm.links.back(), 0.0};
  reach.box = {{column * width, (cells[1] - row - 1.0) * height}, {(column + 1.0) * width, (cells[1] - row) * height}};

  auto scene = std::make_shared<const PlanarScene>(
      World({{0.0, 0.0}, {size[0], size[1]}}, obstacles_of(file.grid(columns, rows), width, height)), Robot::arm(arm));
  const std::string name = std::filesystem::path(text.path).stem().string();
  Problem problem = problem_in(fmt::format("robarm/{}", name), std::move(scene), options);
  problem.start = start;
  problem.reach = reach;
  return {"planar arm of SBPL",
          "metres, radians",
          "the origin is the grid's lower left corner, y up",
          {std::move(problem)}};
}

}  // namespace trellis
