// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <trellis/guide/schedule.hpp>
#include <trellis/strategy/team_parts.hpp>

namespace trellis {

/// Robots that plan together.
template <class P>
struct RobotGroup {
  std::vector<std::size_t> robots;  ///< members, ascending
  std::optional<P> path;            ///< once found; in order, of all robots up to it
};

/// Solves the instance of a team by groups of its robots (Coordination): each finds a path, and then it searches when
/// they move along theirs.
/// \tparam S  a space of robots that follow paths, and of others: TeamSpace, DrivenSpace
/// \tparam G  derives from a RobotGroup
template <class S, class G>
class GroupsSearch : public TeamPartsSearch {
 public:
  using TeamPartsSearch::TeamPartsSearch;

  std::optional<Status> work() override {
    if (timetable_) return schedule();
    if (current_ == nullptr) {
      if (tries_left_ <= 0) return Status::budget_spent;
      if (division_.how != Coordination::order && begin_timetable()) return std::nullopt;
      begin_part();
    }
    advance_part();
    return std::nullopt;
  }

 protected:
  using Groups = std::vector<G>;

  /// The search of when some groups move along their paths.
  struct Timetable {
    Timetable(const Instance& team, const Groups& all, std::vector<std::size_t> some)
        : groups(std::move(some)),
          space(team, paths_of(all, groups), {}, "schedule"),
          paths(space.project(team)),
          search(*paths, cells) {}

    static constexpr std::size_t cells = 16;
    static auto paths_of(const Groups& all, const std::vector<std::size_t>& some) {
      std::vector<typename decltype(G::path)::value_type> along;
      along.reserve(some.size());
      for (const std::size_t g : some) along.push_back(*all[g].path);
      return along;
    }
    [[nodiscard]] bool pair() const { return groups.size() == 2; }

    std::vector<std::size_t> groups;
    S space;
    std::unique_ptr<Instance> paths;
    ScheduleSearch search;
    std::uint64_t checks = 0;
    std::optional<Configurations> found;
  };

  /// Begins the next search of a part.
  virtual void begin_part() = 0;
  /// Continues to search when groups move, and takes what that finds.
  virtual std::optional<Status> schedule() = 0;

  void begin_anew() override {
    groups_.clear();
    passing_.clear();
    all_scheduled_ = false;
    certifies_ = false;
  }

  /// Adds a group for each robot.
  void add_groups() {
    for (const std::size_t i : division_.order) groups_.emplace_back().robots = {i};
    if (division_.how == Coordination::order) return;
    std::sort(groups_.begin(), groups_.end(), [](const G& a, const G& b) { return a.robots < b.robots; });
  }

  /// The first group without a path.
  [[nodiscard]] typename Groups::iterator next_group() {
    return std::find_if(groups_.begin(), groups_.end(), [](const G& group) { return !group.path; });
  }

  void fail() override {
    --tries_left_;
    const auto next = next_group();
    if (division_.how != Coordination::order) {
      // Other paths may be passed.
      if (next != groups_.end() && next->robots.size() == 1) tries_left_ = 0;
      begin_anew();
      return;
    }
    // What a robot cannot do alone, it cannot do among others.
    const std::ptrdiff_t given = division_.given ? 1 : 0;
    if (next - groups_.begin() == given) {
      tries_left_ = 0;
      return;
    }
    // It plans earlier: the paths of the robots that are still before it remain. With several goals another try has
    // another one, to which those paths do not lead.
    const auto kept = std::max(given, context_.instance.goals.size() > 1 ? 0 : (next - groups_.begin()) / 2);
    const auto earlier = groups_.begin() + kept;
    std::rotate(earlier, next, std::next(next));
    for (auto group = earlier; group != groups_.end(); ++group) group->path.reset();
  }

  /// Continues to search when groups move.
  /// \return the search, once it has ended
  std::unique_ptr<Timetable> advance_timetable() {
    Timetable& of = *timetable_;
    constexpr std::uint64_t piece = 256;
    // A pair has few places: all are examined.
    const auto most = of.pair() ? std::numeric_limits<std::size_t>::max() : static_cast<std::size_t>(division_.effort);
    const auto goes_on = [&] { return !of.found && !of.search.exhausted() && of.search.expanded() < most; };
    while (goes_on() && of.paths->checks.validity < piece) of.found = of.search.expand();
    count(*of.paths);
    of.checks += of.paths->checks.validity;
    of.paths->checks = {};
    return goes_on() ? nullptr : std::exchange(timetable_, nullptr);
  }

  /// Groups cannot pass each other: joins the two, or begins anew.
  void separate(const Timetable& ended) {
    if (!ended.pair() || division_.how != Coordination::conflicts) {
      fail();
      return;
    }
    G& group = groups_[ended.groups.front()];
    const auto other = groups_.begin() + static_cast<std::ptrdiff_t>(ended.groups.back());
    std::vector<std::size_t>& robots = group.robots;
    all_scheduled_ = false;
    robots.insert(robots.end(), other->robots.begin(), other->robots.end());
    std::sort(robots.begin(), robots.end());
    group.path.reset();
    groups_.erase(other);
    std::erase_if(passing_, [&](const auto& pair) {
      const auto overlaps = [&](const auto& some) {
        return std::any_of(some.begin(), some.end(),
                           [&](std::size_t i) { return std::binary_search(robots.begin(), robots.end(), i); });
      };
      return overlaps(pair.first) || overlaps(pair.second);
    });
  }

  std::shared_ptr<S> space_;  ///< of the last search
  Groups groups_;             ///< of this try; empty before it begins
  std::set<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> passing_;  ///< pairs that were examined

 private:
  /// Begins to search when groups move along their paths: of each two, and then of all.
  /// \return false where a path is missing, or all these searches have ended
  bool begin_timetable() {
    if (groups_.empty() || next_group() != groups_.end()) return false;
    std::vector<std::size_t> chosen;
    for (std::size_t k = 1; chosen.empty() && k < groups_.size(); ++k) {
      for (std::size_t i = 0; chosen.empty() && i < k; ++i) {
        if (passing_.insert({groups_[i].robots, groups_[k].robots}).second) chosen = {i, k};
      }
    }
    if (chosen.empty()) {
      // One group has no other to wait for, two have been examined together.
      if (std::exchange(all_scheduled_, true)) return false;
      chosen.resize(groups_.size());
      std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    }
    timetable_ = std::make_unique<Timetable>(context_.instance, groups_, std::move(chosen));
    return true;
  }

  std::unique_ptr<Timetable> timetable_;  ///< the search of when to move that has not ended
  bool all_scheduled_ = false;            ///< that of all groups has ended
};

}  // namespace trellis
