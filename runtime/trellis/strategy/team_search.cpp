// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <trellis/guide/team_space.hpp>
#include <trellis/strategy/team_groups.hpp>

namespace trellis {

namespace {

struct Group : RobotGroup<RobotsPath> {
  std::set<std::size_t> blocking;  ///< in order, of those after it: robots whose starts block that path
};

/// The groups of a team without motion models.
class TeamSearch final : public GroupsSearch<TeamSpace, Group> {
 public:
  using GroupsSearch::GroupsSearch;

  std::optional<Status> work() override {
    if (!pruning_) return GroupsSearch::work();
    if (auto path = prune()) keep(std::move(*path));
    return found_ ? std::optional(Status::solved) : std::nullopt;
  }

 private:
  void begin_part() override {
    if (groups_.empty()) {
      if (division_.given) {
        Group& given = groups_.emplace_back();
        given.robots = members_along(*division_.given);
        given.path = *division_.given;
      }
      add_groups();
      if (division_.given) {
        blocking_.clear();
        find_blocking(0);
        groups_.front().blocking = blocking_;
      }
    }
    const auto next = next_group();
    std::vector<std::size_t> robots;
    std::vector<RobotsPath> along;
    if (next == groups_.end()) {
      for (const Group& group : groups_) along.push_back(*group.path);
    } else {
      robots = next->robots;
    }
    // The path of a robot in order is that of all robots up to it.
    if (next != groups_.end() && division_.how == Coordination::order) {
      blocking_ = next == groups_.begin() ? std::set<std::size_t>() : std::prev(next)->blocking;
      const auto place = static_cast<std::size_t>(next - groups_.begin());
      waiting_ = waits_ ? waiting_beside(place) : std::vector<std::size_t>();
      waits_ = !waiting_.empty();
      if (auto path = with_waiting(place, waiting_)) along.push_back(std::move(*path));
    }
    // What a robot finds beside those that wait it finds soon, if at all.
    constexpr double share_beside_waiting = 0.1;
    effort_ = static_cast<double>(division_.effort) * (waiting_.empty() ? 1.0 : share_beside_waiting);
    space_ =
        std::make_shared<TeamSpace>(context_.instance, std::move(along), axes_of(members_, robots), name_of(robots));
    begin_search(part_of(*space_, space_->along().size()), space_, robots);
    if (!robots.empty()) guide_part(robots.size());
  }

  std::optional<Status> end_part(Level& ended) override {
    const Configurations path = shortened(ended);
    if (accepts(ended, path)) begin_pruning_of(space_->placed(path), space_->axes());
    return std::nullopt;
  }

  /// The members that a path moves.
  [[nodiscard]] std::vector<std::size_t> members_along(const RobotsPath& path) const {
    std::vector<std::size_t> along;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (std::binary_search(path.axes().begin(), path.axes().end(), members_[i].axes.front())) along.push_back(i);
    }
    return along;
  }

  /// The path of the robots in order before one, with others that wait at their starts; none without either.
  [[nodiscard]] std::optional<RobotsPath> with_waiting(std::size_t place,
                                                       const std::vector<std::size_t>& waiting) const {
    const std::vector<std::size_t> parked = axes_of(members_, waiting);
    const RobotsPath* before = place == 0 ? nullptr : &*groups_[place - 1].path;
    if (parked.empty()) return before == nullptr ? std::nullopt : std::optional(*before);
    std::vector<std::size_t> axes = parked;
    if (before != nullptr) axes.insert(axes.end(), before->axes().begin(), before->axes().end());
    std::sort(axes.begin(), axes.end());
    Configurations path(axes.size());
    Configuration q(axes.size());
    for (std::size_t i = 0; i < (before == nullptr ? 1 : before->path().size()); ++i) {
      for (std::size_t j = 0, k = 0; j < axes.size(); ++j) {
        const bool moves = before != nullptr && k < before->axes().size() && before->axes()[k] == axes[j];
        q[j] = moves ? before->path()[i][k++] : context_.instance.start[axes[j]];
      }
      path.push(q);
    }
    return RobotsPath(context_.instance.space, std::move(axes), std::move(path));
  }

  /// The robots after one in order that can wait at their starts while it, and those before it, move to their goals.
  [[nodiscard]] std::vector<std::size_t> waiting_beside(std::size_t place) {
    std::vector<std::size_t> waiting;
    for (std::size_t i = place + 1; i < groups_.size(); ++i) {
      const std::size_t robot = groups_[i].robots.front();
      if (blocking_.contains(robot)) continue;
      // Where its start is in the goal of the one that moves, it does not wait there for good.
      TeamSpace both(context_.instance, {}, axes_of(members_, {groups_[place].robots.front(), robot}), "both");
      const auto pair = both.project(context_.instance);
      Configuration q = pair->start;
      const std::vector<std::size_t>& moving = members_[groups_[place].robots.front()].axes;
      for (std::size_t j = 0; j < both.axes().size(); ++j) {
        const std::size_t axis = both.axes()[j];
        if (std::binary_search(moving.begin(), moving.end(), axis)) q[j] = goal()[axis];
      }
      const bool free = pair->valid(q);
      count(*pair);
      if (free) {
        waiting.push_back(robot);
      } else {
        blocking_.insert(robot);
      }
    }
    return waiting;
  }

  /// Finds which robots after one in order block the path found from their starts.
  void find_blocking(std::size_t place) {
    for (std::size_t i = place + 1; i < groups_.size(); ++i) {
      const std::size_t robot = groups_[i].robots.front();
      if (blocking_.contains(robot)) continue;
      TeamSpace space(context_.instance, {*with_waiting(place + 1, {robot})}, {}, "waiting");
      const auto along = space.project(context_.instance);
      if (!along->motion(along->start, along->goal()).valid) blocking_.insert(robot);
      count(*along);
    }
  }

  /// Takes a path that a search found, of the robots of its space.
  void keep(Configurations path) {
    const bool all = path.dimension() == context_.instance.space.dimension();
    const auto next = next_group();
    if (next != groups_.end() && next->robots.size() > 1) {
      note_joined(next->robots, levels_.back()->instance().checks.validity);
    }
    if (next == groups_.end() || (all && waiting_.empty())) {
      finish(std::move(path));
      return;
    }
    next->path = without_waiting(path);
    if (waiting_.empty() && division_.how == Coordination::order) {
      find_blocking(static_cast<std::size_t>(next - groups_.begin()));
    }
    next->blocking = blocking_;
    waits_ = true;
  }

  /// The path that the last search found, without the robots that wait.
  [[nodiscard]] RobotsPath without_waiting(const Configurations& path) const {
    const std::vector<std::size_t> parked = axes_of(members_, waiting_);
    std::vector<std::size_t> axes, columns;
    for (std::size_t j = 0; j < space_->axes().size(); ++j) {
      if (std::binary_search(parked.begin(), parked.end(), space_->axes()[j])) continue;
      axes.push_back(space_->axes()[j]);
      columns.push_back(j);
    }
    Configurations moving(axes.size());
    for (std::size_t i = 0; i < path.size(); ++i) moving.push(picked(path[i], columns));
    return {context_.instance.space, std::move(axes), std::move(moving)};
  }

  /// Begins to prune a path of some robots: later searches follow it, and each motion of theirs has a piece for each of
  /// its configurations.
  void begin_pruning_of(const Configurations& path, const std::vector<std::size_t>& axes) {
    const Instance& team = context_.instance;
    if (axes.size() == team.space.dimension()) {
      begin_pruning(team, path);
    } else {
      begin_pruning(*TeamSpace(team, {}, axes, "placed").project(team), path);
    }
  }

  void fail() override {
    if (!waiting_.empty()) {
      // Again, without those that wait.
      waits_ = false;
      return;
    }
    waits_ = true;
    const auto next = next_group();
    if (division_.how == Coordination::order && !division_.of_window && next != groups_.begin()) {
      TeamConflict& conflict = run_.conflicts.emplace_back();
      conflict.robots = numbers_of(next->robots);
      conflict.resolved = TeamConflict::Resolved::order;
      conflict.checks = levels_.back()->instance().checks.validity;
    }
    GroupsSearch::fail();
  }

  std::optional<Status> schedule() override {
    const auto ended = advance_timetable();
    if (!ended) return std::nullopt;
    if (ended->pair()) note_pair(*ended);
    if (ended->found && ended->groups.size() == groups_.size()) {
      begin_pruning_of(ended->space.placed(*ended->found), ended->space.axes());
    } else if (!ended->found && ended->pair()) {
      separate(*ended);
    }
    return std::nullopt;
  }

  /// Records whether two groups conflict that move along their paths, both in equal shares of theirs, and whether they
  /// can wait for each other.
  void note_pair(const Timetable& ended) {
    if (ended.found && ended.found->size() <= Timetable::cells + 1) return;
    const std::vector<std::size_t>& first = groups_[ended.groups[0]].robots;
    const std::vector<std::size_t>& second = groups_[ended.groups[1]].robots;
    TeamConflict& conflict = run_.conflicts.emplace_back();
    conflict.robots = numbers_of(first);
    for (const std::size_t number : numbers_of(second)) conflict.robots.push_back(number);
    std::sort(conflict.robots.begin(), conflict.robots.end());
    // Of groups of several it is not known which robots touch.
    if (conflict.robots.size() == 2) conflict.touching = {conflict.robots};
    if (ended.found) conflict.resolved = TeamConflict::Resolved::schedule;
    conflict.checks = ended.checks;
  }
  /// Notes that groups that were joined have a path.
  void note_joined(const std::vector<std::size_t>& robots, std::uint64_t checks) {
    const std::vector<std::size_t> numbers = numbers_of(robots);
    for (TeamConflict& conflict : run_.conflicts) {
      if (conflict.robots != numbers || conflict.resolved != TeamConflict::Resolved::none) continue;
      conflict.resolved = TeamConflict::Resolved::together;
      conflict.checks += checks;
    }
  }

  bool waits_ = true;                 ///< in order: the next search first tries beside robots that wait
  std::vector<std::size_t> waiting_;  ///< in order: robots that wait at their starts, of the last search
  std::set<std::size_t> blocking_;    ///< in order: robots that cannot wait at their starts any more
};

}  // namespace

std::unique_ptr<Planner> make_team_search(TeamSearchContext context) {
  return std::make_unique<TeamSearch>(std::move(context));
}

}  // namespace trellis
