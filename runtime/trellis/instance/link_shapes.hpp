// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

// What the shapes of a manipulator's links touch at single configurations: starts, goals, named states. Planning
// compares the balls that cover the shapes, which protrude a little; here the shapes themselves decide.

namespace trellis {

/// What the shapes of a manipulator's links touch at a configuration.
struct ShapeReport {
  /// The first contact in the order of links; none where the shapes touch nothing.
  std::optional<Contact> contact;
  /// For each link the excess of a cover below which its balls touch nothing, in metres: its distance from obstacles
  /// and boundary, and its share of that from another link (ShapeChecker::divide). Of distances that the covers at hand
  /// decide, infinity.
  std::vector<double> room;
};

/// Compares the shapes of a manipulator's links with the world and with each other, by FCL. One query takes about a
/// millisecond: it is for single configurations. Only one thread may use it at a time.
class ShapeChecker {
 public:
  /// \param scene  of a manipulator
  explicit ShapeChecker(std::shared_ptr<const Scene> scene);
  ~ShapeChecker();
  ShapeChecker(ShapeChecker&&) noexcept;
  ShapeChecker& operator=(ShapeChecker&&) noexcept;
  ShapeChecker(const ShapeChecker&) = delete;
  ShapeChecker& operator=(const ShapeChecker&) = delete;

  /// \param q  finite coordinates
  [[nodiscard]] ShapeReport at(View q);
  /// Returns the distance of two links, 0 in contact, in metres.
  /// \param place  of the second one in the frame of the first
  [[nodiscard]] double distance(std::size_t first, std::size_t second, const Pose3& place);
  /// Whether covers exist that touch nothing where the report was made.
  [[nodiscard]] bool fits(const ShapeReport& report);
  /// The least excess of a cover of the link, as `finest_excess`; 0 where the link is made of spheres.
  [[nodiscard]] double finest(std::size_t link);
  /// Divides the distance of two links among their covers: each gets its least excess, and half of the rest.
  [[nodiscard]] std::pair<double, double> divide(double distance, std::size_t first, std::size_t second);

 private:
  class Distance;
  Distance& of_world(std::size_t link);
  Distance& of_links(std::size_t first, std::size_t second);

  std::shared_ptr<const Scene> scene_;
  std::vector<BodySphere> wholes_;  ///< for each link a ball that contains its cover
  std::vector<double> finest_;      ///< for each link; NaN before it is needed
  std::map<std::pair<std::size_t, std::size_t>, std::unique_ptr<Distance>> known_;
};

/// The least excess of a cover that `fit_covers` makes for a link, in metres: 1 mm, or more where the link is large.
double finest_excess(const Link& link);

using CoverMaker = std::function<MedialCover(std::span<const Solid>, const CoverOptions&)>;

/// Covers links of a manipulator with finer balls where the problem's start or one of its goals needs it: where balls
/// touch something and the shapes do not. Each such link gets an excess of a half, a quarter, ... of the robot's, the
/// first at which the ends are valid. Ends that are not valid for another reason stay as they are. Nothing happens to
/// problems of other robots.
/// \param cover  makes a cover
/// \return a sentence for each problem that was changed: which links, and by how many balls
std::vector<std::string> fit_covers(
    Problem& problem,
    const CoverMaker& cover = [](auto solids, const auto& options) { return medial_cover(solids, options); });

/// Two links that do not move against each other and are in contact, or nearer than any covers decide.
struct StandingContact {
  std::size_t first = 0;
  std::size_t second = 0;
  double distance = 0.0;  ///< of their shapes, in metres
};

/// Returns the robot whose links that do not move against each other are compared by their shapes, where their covers
/// touch. The result is that of the robot whose joints all move, at a start (EndChecker).
/// \param contacts  receives the pairs in contact: no configuration is valid with one
SphereModel with_standing_shapes(const SphereModel& robot, std::vector<StandingContact>& contacts);

}  // namespace trellis
