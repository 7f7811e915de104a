// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <trellis/guide/axis_projection.hpp>
#include <trellis/guide/guide.hpp>

namespace trellis {

/// A path of some robots of a team, by its length.
class RobotsPath {
 public:
  /// \param team  the space of the team
  /// \param axes  of the team, ascending: those of the robots that follow the path
  /// \param path  of these axes, at least one configuration
  RobotsPath(const Space& team, std::vector<std::size_t> axes, Configurations path);

  [[nodiscard]] const std::vector<std::size_t>& axes() const { return axes_; }
  [[nodiscard]] const Configurations& path() const { return path_; }
  [[nodiscard]] double length() const { return at_.back(); }
  /// Writes where the robots are after s metres of the path.
  /// \param s    beyond an end of the path: that end
  /// \param out  a number for each axis
  void at(double s, MutableView out) const;
  /// Returns after how many metres of the path its robots are nearest to a configuration of theirs; exact for a point
  /// of the path.
  [[nodiscard]] double nearest(View q) const;
  /// Adds the parameters in (0, 1), of a motion from a to b metres along the path, at which it passes a configuration
  /// of the path.
  void add_passed(double a, double b, std::vector<double>& parameters) const;

 private:
  std::vector<std::size_t> axes_;
  Space space_;  ///< of the axes
  Configurations path_;
  std::vector<double> at_;  ///< the length up to each configuration
};

/// A space of some robots of a team: robots that follow a path found before have one coordinate in all, the metres
/// along it, and the others their own. A configuration of it places its robots; the rest of the team is not there.
///
/// Where no robot follows a path, S keeps axes of C, and its fibres are uniform; else it is a set of C of lower
/// dimension, or one that is projected to it, and h needs no density of it.
class TeamSpace final : public Guide {
 public:
  /// \param parent  the instance of the whole team; outlives this object
  /// \param along   paths of robots, none twice
  /// \param free    axes of the other robots of this space, ascending
  /// \param name    of the space
  TeamSpace(const Instance& parent, std::vector<RobotsPath> along, const std::vector<std::size_t>& free,
            std::string name);

  std::unique_ptr<Instance> project(const Instance& parent) override;
  void project(View q, MutableView s) const override;
  void lift(View s, Stream& stream, MutableView q) const override;
  [[nodiscard]] double log_fibre_density(View q) const override;
  [[nodiscard]] bool closed_fibre() const override;
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override;

  /// The axes of the team that it places, ascending.
  [[nodiscard]] const std::vector<std::size_t>& axes() const;
  /// The paths that it follows: its first coordinates.
  [[nodiscard]] const std::vector<RobotsPath>& along() const;
  /// Returns a path of this space as one of `axes`: with what the paths that it follows turn at.
  [[nodiscard]] Configurations placed(const Configurations& path) const;

 private:
  class Embedding;

  std::shared_ptr<const Embedding> embedding_;
  std::string name_;
};

}  // namespace trellis
