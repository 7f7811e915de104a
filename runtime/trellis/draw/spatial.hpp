// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <trellis/draw/canvas.hpp>
#include <trellis/draw/planar.hpp>
#include <trellis/draw/surface.hpp>

/// Pictures of a world of space and of the samples in it, from plain numbers: seen from far away (orthographic), with
/// nearer parts over farther ones. Points are in metres, z up.
namespace trellis::draw {

/// The direction from which a picture of space is seen, in degrees.
struct Camera {
  double azimuth = -60.0;   ///< from the x axis, counter-clockwise seen from above
  double elevation = 30.0;  ///< above the horizon, in [-90, 90]

  [[nodiscard]] Point3 direction() const;  ///< towards the camera
  [[nodiscard]] Point3 right() const;      ///< of the picture
  [[nodiscard]] Point3 up() const;
};

/// Returns the default view of a box: the flatter it is, the more from above.
Camera camera_for(const Point3& lo, const Point3& hi);

/// Whether an obstacle closes the view into a box: it lies before a side that faces the camera, and covers most of it.
bool closes_view(const Surface& surface, const Point3& lo, const Point3& hi, const Camera& camera);

/// The cells in which to count samples of a world of space: cubes from the lowest corner on; those at the other sides
/// may be cut.
/// \throws Fault for a world or cells without volume, and for more than a million cells.
class Grid3 {
 public:
  Grid3(const Point3& lo, const Point3& hi, double cell);

  [[nodiscard]] double cell() const { return cell_; }
  [[nodiscard]] std::size_t size() const { return counts_[0] * counts_[1] * counts_[2]; }
  /// Adds a sample to the counts of the cells. Returns false, and adds nothing, outside of the world.
  bool count(const Point3& p, double weight, std::vector<double>& counts) const;
  /// Returns the centre of the part of the cell that lies within the world.
  [[nodiscard]] Point3 centre(std::size_t index) const;

 private:
  Point3 lo_;
  Point3 hi_;
  double cell_;
  std::array<std::size_t, 3> counts_{};
};

struct SpatialPanel {
  std::string title{};
  std::vector<CircleLayer> layers{};  ///< the mean count of each of the cells
  std::vector<std::vector<Point3>> paths{};
  std::vector<std::pair<Point3, Point3>> tree{};  ///< edges of a tree or a roadmap
  std::vector<Point3> failed{};                   ///< proposals that led to no node
  std::vector<Surface> poses{};                   ///< the robot on its path, without start and goal
  std::vector<bool> invalid{};                    ///< of each pose
  std::vector<Surface> start{};                   ///< instead of the figure's, where there is one
  std::vector<Surface> goal{};
  std::string note{};
};

/// One world in panels row by row. Parts behind obstacles are drawn faintly above them: paths, samples, start and goal.
struct SpatialFigure {
  std::string title{};
  std::string caption{};
  Point3 lo{};  ///< of the world's bounds
  Point3 hi{};
  double cell = 0.5;
  std::vector<Surface> obstacles{};  ///< those that close the view are left out, and what is far outside is cut off
  std::vector<Surface> start{};      ///< the robot's solids at the start
  std::vector<Surface> goal{};
  Point3 start_at{};  ///< the robot's reference points, marked where the robot is too small to be seen
  Point3 goal_at{};
  std::vector<SpatialPanel> panels{};
  Camera camera{};
  std::size_t columns = 3;
  RoleColours colours = RoleColours::safe;
  double width = 504.0;      ///< points
  bool strong_path = false;  ///< a path is the subject of the picture, not its background
};

/// Draws a figure on white. Its panels and texts determine its height.
Canvas plot(const SpatialFigure& figure);

}  // namespace trellis::draw
