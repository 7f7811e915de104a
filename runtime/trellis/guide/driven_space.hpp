// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <trellis/guide/guide.hpp>
#include <trellis/motion/team_model.hpp>

namespace trellis {

/// A motion of some robots of a team, step by step. Rows are those of the whole team; the numbers of other robots have
/// no meaning.
struct DrivenPath {
  std::vector<std::size_t> robots;  ///< members, ascending
  Configurations states;            ///< at the start, and after each step
  Configurations controls;          ///< of each step

  [[nodiscard]] std::size_t steps() const { return controls.size(); }
};

/// A space of some robots of a team that are driven by motion models: robots that follow a motion found before have one
/// coordinate in all, the seconds along it, and the others the coordinates of their states. Robots along a motion
/// continue by whole steps, under the controls found before, or wait; they never go back. The rest of the team is not
/// there.
///
/// Its motion model drives all of them, so kinodynamic planners search it.
class DrivenSpace final : public Guide {
 public:
  /// \param parent  the instance of the whole team, with a TeamModel; outlives this object
  /// \param along   motions of robots, none twice
  /// \param robots  the other robots of this space, ascending
  /// \param name    of the space
  DrivenSpace(const Instance& parent, std::vector<DrivenPath> along, std::vector<std::size_t> robots,
              const std::string& name);

  std::unique_ptr<Instance> project(const Instance& parent) override;
  void project(View q, MutableView s) const override;
  void lift(View s, Stream& stream, MutableView q) const override;
  [[nodiscard]] double log_fibre_density(View q) const override;
  [[nodiscard]] bool closed_fibre() const override;
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override;

  /// The number of motions that robots follow: of its first coordinates.
  [[nodiscard]] std::size_t clocks() const;
  /// Returns the motion of its robots along a path of this space.
  /// \param found  of a search, with its trajectory; or the path of a schedule, which has none: then robots that get
  ///     less far between two of its configurations wait at the end
  [[nodiscard]] DrivenPath driven(const Solution& found) const;

 private:
  class Placement;

  std::shared_ptr<const Placement> placement_;
};

}  // namespace trellis
