// SPDX-License-Identifier: GPL-3.0-or-later
// What the searches share that divide the instance of a team by its robots.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/planner/pruning.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/strategy/dividing_planner.hpp>
#include <trellis/strategy/team_search.hpp>

namespace trellis {

/// The displacement at which a certificate of a motion gives up, in metres.
double exact_tolerance_of(const Instance& instance);

/// Whether a path is certified; its instance pays for the checks.
bool certified(Instance& instance, const Configurations& path);

/// Some coordinates of a configuration.
Configuration picked(View q, const std::vector<std::size_t>& columns);

/// Solves the instance of a team by instances of its robots, one after another. Each step searches a part of them for a
/// while.
class TeamPartsSearch : public DividingPlanner {
 public:
  explicit TeamPartsSearch(TeamSearchContext of);

  std::optional<Status> begin(const Budget& budget) final;
  [[nodiscard]] bool draws() const final { return false; }
  Plan plan() final { return {.proposal = false}; }
  Outcome extend(View) final { throw Fault("a search of the parts of a team draws no proposal"); }
  [[nodiscard]] Solution solution(Status status) override;
  [[nodiscard]] Part part() final;
  std::optional<Status> take(Advance advance) final;

 protected:
  /// Forgets the parts of this try.
  virtual void begin_anew() = 0;
  /// Takes what the search of a part found.
  virtual std::optional<Status> end_part(Level& ended) = 0;
  /// A search found no path: changes the division, or begins anew.
  virtual void fail() = 0;

  /// The goal of this try: the robots of one search must go to the same one as those of another.
  [[nodiscard]] const Configuration& goal() const;
  /// The instance of a part with the goal of this try.
  /// \param along  how many of its first coordinates are places along paths
  std::unique_ptr<Instance> part_of(Guide& space, std::size_t along);
  /// Begins the search of a part.
  /// \param robots  members; none: all are along paths
  void begin_search(std::unique_ptr<Instance> part, std::shared_ptr<Guide> space,
                    const std::vector<std::size_t>& robots);
  /// Guides the search of so many robots that has begun, where the guide applies.
  void guide_part(std::size_t robots);
  /// Continues the search of a part in this step.
  void advance_part() { advances_ = true; }
  /// Whether the path of a part is certified. What touches another robot between two checked configurations leads
  /// nowhere: the same search begins again, and then certifies each of its motions.
  bool accepts(Level& ended, const Configurations& path);
  /// The path found by a search of robots with its detours cut: later searches follow it.
  [[nodiscard]] Configurations shortened(Level& ended) const;

  /// Begins to prune a path of the robots of an instance.
  void begin_pruning(const Instance& instance, const Configurations& path);
  /// Continues to prune.
  /// \return the path, once it is done
  std::optional<Configurations> prune();
  /// Takes the path of the team, and adds it to the nodes of this search.
  void finish(Configurations path);

  /// Pays here for the checks of a part's instance.
  void count(const Instance& part);
  /// The numbers of members.
  [[nodiscard]] std::vector<std::size_t> numbers_of(const std::vector<std::size_t>& robots) const;
  /// "robot 3", "robots 2, 5"; "coordination" of none.
  [[nodiscard]] std::string name_of(const std::vector<std::size_t>& robots) const;

  Run& run_;
  Level& level_;
  PlannerSpec planner_;
  const GuideSpec* guide_;
  TeamDivision division_;
  std::vector<TeamMember> members_;
  std::vector<std::unique_ptr<Level>> levels_;             ///< of all searches; their records are taken after the run
  Level* current_ = nullptr;                               ///< the search that has not ended
  bool advances_ = false;                                  ///< this step continues it
  std::map<std::size_t, std::size_t> searches_;            ///< so far, by the number of their robots
  std::size_t next_number_ = members_.size() + 1;          ///< of a search of several robots
  double effort_ = static_cast<double>(division_.effort);  ///< proposals of a search
  std::int64_t tries_left_ = division_.tries;
  bool certifies_ = false;  ///< the search certifies each of its motions: the one before found a path that touches
  std::optional<PathPruning> pruning_;  ///< of a path that is not pruned yet
  std::optional<Configurations> found_;
};

}  // namespace trellis
