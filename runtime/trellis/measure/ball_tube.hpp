// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/measure/tube.hpp>

namespace trellis::measure {

/// The tube of a space with rotations, or of many axes, in any number of dimensions.
///
/// The cover is the union of balls about centres along P, each counted as often as it overlaps others: a centre, a
/// point uniform in the ball of tangent vectors there, and `exp` of it. A point x of the space then has the density (1
/// / K V) sum over the centres c whose balls contain it of 1 / J_c(x), with K centres, balls of volume V, and J the
/// factor by which `exp` changes volumes. Accepting x with the probability 1 / sum of 1 / J_c(x) makes the points
/// uniform over the union with the density 1 / K V. Of these, those nearer to P than the radius are uniform in the
/// tube, and their share is |tube| / K V.
///
/// Factors of the space that the distance leaves out are uniform, by the map from the unit cube.
class BallTube : public Tube {
 public:
  /// The parameters of `make_tube`.
  BallTube(const Frame& frame, const Configurations& path, std::vector<std::size_t> axes, double radius);

  [[nodiscard]] bool contains(View y) const override;
  [[nodiscard]] double distance(View y) const override;
  [[nodiscard]] double length() const override { return length_; }
  [[nodiscard]] double along(View y) const override;
  [[nodiscard]] double log_cover_volume() const override { return log_cover_volume_; }
  [[nodiscard]] std::size_t unit_dimension() const override;
  bool draw(View unit, MutableView y) const override;

 private:
  /// One factor of the space, and its place in rows of the measured space or among the free numbers of the unit cube.
  struct Column {
    std::size_t row = 0;    ///< first coordinate in a row of the space
    std::size_t part = 0;   ///< first coordinate in a row of the measured or of the free space
    std::size_t width = 1;  ///< coordinates
    bool measured = true;
  };
  /// The nearest point of P.
  struct Nearest {
    double squared_distance = 0.0;
    double arc = 0.0;
  };

  void choose_spaces();
  void cut_path(const Configurations& path);
  void choose_centres();
  /// The measured part of a configuration.
  [[nodiscard]] Configuration measured(View x) const;
  /// The measured part of the configuration of a row.
  [[nodiscard]] Configuration measured_of_row(View y) const;
  /// Returns the nearest point of P, exact where it is nearer than `horizon`.
  [[nodiscard]] Nearest nearest(View z, double horizon) const;
  /// Whether a point lies nearer to P than the radius.
  [[nodiscard]] bool holds(View z) const;
  /// Returns how many times more often than once, by volume, the cover holds a point: the sum of 1 / J over the balls
  /// that contain it.
  [[nodiscard]] double multiplicity(View z, std::size_t own, View tangent) const;

  Space space_;  ///< of the factors that the distance is over
  Space rest_;   ///< of the others
  std::vector<Column> columns_;
  Configurations ends_;        ///< of the pieces of P: piece i leads from end i to the next
  std::vector<double> begin_;  ///< arc length at each end
  double length_ = 0.0;
  Configurations centres_;  ///< of the cover's balls
  double reach_ = 0.0;      ///< their radius
  double pace_ = 0.0;       ///< the largest distance from one to the next
  double log_cover_volume_ = 0.0;
};

}  // namespace trellis::measure
