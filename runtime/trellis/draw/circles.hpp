// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/draw/canvas.hpp>
#include <trellis/draw/planar.hpp>

/// The circles that stand for samples, in pictures of the plane and of space.
namespace trellis::draw {

/// The look of a role's circles.
struct CircleLook {
  Colour colour;
  double filling = 0.0;  ///< opacity
  bool ringed = true;
};

/// Beside other roles, the strategy's own circles are rings on top of the others.
/// \param alone  whether the panel has no other role
CircleLook circle_look(Role role, RoleColours colours, bool alone);

/// Returns the layers of a panel from the lowest to the highest: filled circles below rings.
std::vector<CircleLayer> below_each_other(const std::vector<CircleLayer>& layers);

/// Returns the radius of a circle of this area.
double circle_radius(double area);

/// Returns the point in steps of a twentieth of a point, which makes files smaller.
Point step(Point p);
Path stepped(const Path& path);

/// Circles of one look on paper. The outer edges of their rings have the given radii.
class Circles {
 public:
  /// \param stepped  whether their coordinates are in steps of a twentieth
  explicit Circles(bool stepped = false) : stepped_(stepped) {}

  void add(Point at, double radius);
  void draw(Canvas& canvas, const CircleLook& look) const;

 private:
  bool stepped_;
  Path discs_;
  Path rings_;
  Path dots_;
};

/// The height in points of the row that draw_circle_sizes() draws.
double circle_sizes_height(const std::vector<double>& sizes, double area);
/// Draws circles of some sizes beside their counts, below a panel.
/// \param sizes  mean counts per cell, ascending, at least one
/// \param area   square points for each sample
void draw_circle_sizes(Canvas& canvas, const std::vector<double>& sizes, double area, const CircleLook& look,
                       const Rect& plot);
/// Returns the sizes whose circles are large enough to be seen.
std::vector<double> visible_sizes(std::vector<double> sizes, double area);

/// Draws a note across a panel, as "no samples".
void draw_note(Canvas& canvas, const std::string& text, const Rect& plot);

}  // namespace trellis::draw
