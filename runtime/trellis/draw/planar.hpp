// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <trellis/draw/canvas.hpp>
#include <trellis/draw/palette.hpp>

/// Pictures of a planar world and of where in it samples lie, from plain numbers. Points and rectangles of the world
/// are in metres, x right and y up; a rectangle's x and y are its lower left corner.
namespace trellis::draw {

/// What a layer of circles stands for.
enum class Role : std::uint8_t { target, tree, expansion, baseline };

/// `safe`: told apart with any colour vision; `paper`: red, blue, purple and green, as in Attali et al. 2022.
enum class RoleColours : std::uint8_t { safe, paper };
Colour colour_of(Role role, RoleColours colours);

/// The cells of a world in which samples are counted: squares from the lower left corner on; those at the right and the
/// upper edge are what is left. Throws Fault for a world or cells without area, and for more than a million cells.
class Grid {
 public:
  Grid(const Rect& world, double cell);

  [[nodiscard]] double cell() const { return cell_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t size() const { return columns_ * rows_; }
  /// Adds a sample to the counts of the cells, row by row from the lowest; on an edge in equal parts to the cells
  /// there, so that no side is preferred. Returns false, and adds nothing, outside of the world.
  bool count(Point p, double weight, std::vector<double>& counts) const;
  /// Of what of the cell lies within the world.
  [[nodiscard]] Point centre(std::size_t index) const;

 private:
  Rect world_;
  double cell_;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
};

/// A disc of the world; without a radius it is a point, which is marked.
struct WorldDisc {
  Point centre{};
  double radius = 0.0;
};
/// A polygon or a disc.
using WorldShape = std::variant<std::vector<Point>, WorldDisc>;

struct CircleLayer {
  std::string name{};  ///< in the legend
  Role role = Role::tree;
  std::vector<double> mean{};  ///< the mean count of each of the grid's cells
};

struct PlanarPanel {
  std::string title{};
  std::vector<CircleLayer> layers{};  ///< above each other
  std::vector<std::vector<Point>> paths{};
  std::string note{};  ///< printed across the world, as "no samples"
};

/// One world, seen in panels row by row. Each has a scale of its own, which is given below it.
struct PlanarFigure {
  std::string title{};
  std::string caption{};
  Rect world{};
  double cell = 0.5;
  std::vector<WorldShape> obstacles{};
  std::vector<WorldShape> start{};  ///< the robot's parts where it starts
  std::vector<WorldShape> goal{};
  std::vector<PlanarPanel> panels{};
  std::size_t columns = 3;
  RoleColours colours = RoleColours::safe;
  double width = 504.0;    ///< points
  bool scale_bar = false;  ///< in the first panel: a length of the world, in metres
};

/// The area of a circle for each sample of the mean count, square metres; one scale for all layers of a panel. Nearly
/// all circles fit into their cells: those of the fullest twentieth may reach into the next ones. 0 without samples.
double area_per_sample(const PlanarPanel& panel, const Grid& grid);

/// Mean counts to explain a panel's circles by, ascending: round numbers up to the largest.
std::vector<double> sizes_explained(const PlanarPanel& panel);

/// Draws a figure on white, what lies outside of the world cut off. Its height is what its panels and texts need.
Canvas plot(const PlanarFigure& figure);

}  // namespace trellis::draw
