// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <trellis/draw/canvas.hpp>
#include <trellis/draw/palette.hpp>

/// Pictures of a planar world and of the samples in it, from plain numbers. Points and rectangles of the world are in
/// metres, x to the right and y up; a rectangle's x and y are its lower left corner.
namespace trellis::draw {

/// The meaning of a layer of circles.
enum class Role : std::uint8_t { target, tree, expansion, baseline };

/// `safe`: distinguishable with any colour vision; `paper`: red, blue, purple and green, as in Attali et al. 2022.
enum class RoleColours : std::uint8_t { safe, paper };
Colour colour_of(Role role, RoleColours colours);

/// The cells in which to count samples of a world: squares from the lower left corner on; those at the right and the
/// upper edge may be cut.
/// \throws Fault for a world or cells without area, and for more than a million cells.
class Grid {
 public:
  Grid(const Rect& world, double cell);

  [[nodiscard]] double cell() const { return cell_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t size() const { return columns_ * rows_; }
  /// Adds a sample to the counts of the cells, row by row from the lowest. A sample on an edge counts in equal parts
  /// for the cells at the edge, so that no side is preferred. Returns false, and adds nothing, outside of the world.
  bool count(Point p, double weight, std::vector<double>& counts) const;
  /// Returns the centre of the part of the cell that lies within the world.
  [[nodiscard]] Point centre(std::size_t index) const;

 private:
  Rect world_;
  double cell_;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
};

/// A disc of the world; without a radius it is a point, drawn as a mark.
struct WorldDisc {
  Point centre{};
  double radius = 0.0;
};
/// A polygon or a disc.
using WorldShape = std::variant<std::vector<Point>, WorldDisc>;

struct CircleLayer {
  std::string name{};  ///< in the legend
  Role role = Role::tree;
  std::vector<double> mean{};      ///< the mean count of each of the grid's cells
  std::optional<Colour> colour{};  ///< of a robot of a team, instead of the role's
};

/// A robot of a team, in its colour.
struct TeamRobot {
  std::string name{};  ///< printed on it: "3"
  Colour colour{};
  std::vector<WorldShape> start{};  ///< its parts: filled, at a goal an outline
  std::vector<WorldShape> goal{};
};

/// The path of a robot of a team.
struct TeamPath {
  Colour colour{};
  std::vector<Point> points{};
};

struct PlanarPanel {
  std::string title{};
  std::vector<CircleLayer> layers{};  ///< drawn on top of each other
  std::vector<std::vector<Point>> paths{};
  std::string note{};  ///< printed across the world, as "no samples"
  std::vector<TeamPath> team_paths{};
  std::vector<std::vector<WorldShape>> team_at{};  ///< the robots of the team at one moment; empty: at their starts
};

/// One world in panels row by row. Each panel has its own scale of circles, which the legend below it shows.
struct PlanarFigure {
  std::string title{};
  std::string caption{};
  Rect world{};
  double cell = 0.5;
  std::vector<WorldShape> obstacles{};
  std::vector<WorldShape> start{};  ///< the robot's parts at the start
  std::vector<WorldShape> goal{};
  std::vector<TeamRobot> team{};
  std::vector<PlanarPanel> panels{};
  std::size_t columns = 3;
  RoleColours colours = RoleColours::safe;
  double width = 504.0;    ///< points
  bool scale_bar = false;  ///< below the first panel: a length of the world, in metres
};

/// Returns the area of a circle per sample of the mean count, square metres; one scale for all layers of a panel.
/// Nearly all circles fit into their cells: those of the fullest twentieth may overlap the next cells. 0 without
/// samples.
/// \param cell  the side of a cell, metres
double area_per_sample(const std::vector<CircleLayer>& layers, double cell);

/// Returns mean counts for the legend of a panel's circles, ascending: round numbers up to the largest.
std::vector<double> sizes_explained(const std::vector<CircleLayer>& layers);

/// Draws a figure on white, clipped to the world. Its panels and texts determine its height.
Canvas plot(const PlanarFigure& figure);

}  // namespace trellis::draw
