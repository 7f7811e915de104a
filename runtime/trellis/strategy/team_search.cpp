// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/team_search.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/schedule.hpp>
#include <trellis/guide/team_space.hpp>
#include <trellis/instance/certified_validity.hpp>
#include <trellis/planner/loop.hpp>
#include <trellis/planner/pruning.hpp>
#include <trellis/strategy/team_parts.hpp>

namespace trellis {

namespace {

/// Solves the instance of a team by instances of its robots (Coordination). Each step searches a part of them for a
/// while.
class TeamSearch final : public Planner {
 public:
  TeamSearch(Run& run, Level& level, PlannerSpec planner, const GuideSpec* guide, TeamDivision division,
             PlannerContext context)
      : Planner(std::move(context)),
        run_(run),
        level_(level),
        planner_(std::move(planner)),
        guide_(guide),
        division_(std::move(division)),
        members_(context_.instance.scene->members()),
        tries_left_(division_.tries) {}

  std::optional<Status> begin(const Budget&) override {
    Instance& instance = context_.instance;
    if (context_.search.nodes.empty()) {
      if (const auto invalid = remove_invalid_goals(instance)) return invalid;
      context_.search.nodes.push(instance.start);
      context_.search.parents.push_back(0);
    }
    // A further solve begins anew, with other random numbers.
    if (found_ || tries_left_ <= 0) {
      found_.reset();
      groups_.clear();
      passing_.clear();
      all_scheduled_ = false;
      certifies_ = false;
      tries_left_ = division_.tries;
    }
    if (instance.to_goal(instance.start) > instance.goal_tolerance) return std::nullopt;
    found_ = path_of_start(instance);
    return Status::solved;
  }

  [[nodiscard]] bool draws() const override { return false; }

  std::optional<Status> step() override {
    if (pruning_) return prune();
    if (timetable_) return schedule();
    if (current_ == nullptr) {
      if (tries_left_ <= 0) return Status::budget_spent;
      if (division_.how != Coordination::order && begin_timetable()) return std::nullopt;
      begin_part();
    }
    constexpr double piece = 256.0;
    // What a robot finds beside those that wait it finds soon, if at all.
    constexpr double share_beside_waiting = 0.1;
    const double effort = static_cast<double>(division_.effort) * (waiting_.empty() ? 1.0 : share_beside_waiting);
    const Advance advance = current_->advance(std::ceil(effort), {Budget::unlimited, piece});
    double work = 0.0;
    for (const auto& level : levels_) work += level->work();
    level_.count_parts(work);
    if (advance == Advance::unfinished) return std::nullopt;
    Level& ended = *std::exchange(current_, nullptr);
    if (ended.record().solution.status == Status::interrupted) return Status::interrupted;
    if (advance == Advance::nothing) {
      certifies_ = false;
      fail();
      return std::nullopt;
    }
    const Configurations path = shortened(run_, ended);
    // What touches another robot between two checked configurations leads nowhere: again, and then each motion is
    // certified.
    if (!certifies_ && !certified(ended.instance(), path)) {
      certifies_ = true;
      return std::nullopt;
    }
    certifies_ = false;
    begin_pruning(space_->placed(path), space_->axes());
    return std::nullopt;
  }

  [[nodiscard]] Solution solution(Status status) override {
    if (status == Status::solved && found_) return {status, *found_, {}};
    return {status, path_of_start(context_.instance), {}};
  }

 private:
  /// Robots that plan together.
  struct Group {
    std::vector<std::size_t> robots;  ///< members, ascending
    std::optional<RobotsPath> path;   ///< once found; in order, of all robots up to it
    std::set<std::size_t> blocking;   ///< in order, of those after it: robots whose starts block that path
  };

  /// The search of when some groups move along their paths.
  struct Timetable {
    Timetable(const Instance& team, const std::vector<Group>& all, std::vector<std::size_t> some)
        : groups(std::move(some)),
          space(team, paths_of(all, groups), {}, "schedule"),
          paths(space.project(team)),
          search(*paths, cells) {}

    static constexpr std::size_t cells = 16;
    static std::vector<RobotsPath> paths_of(const std::vector<Group>& all, const std::vector<std::size_t>& some) {
      std::vector<RobotsPath> along;
      along.reserve(some.size());
      for (const std::size_t g : some) along.push_back(*all[g].path);
      return along;
    }

    std::vector<std::size_t> groups;
    TeamSpace space;
    std::unique_ptr<Instance> paths;
    ScheduleSearch search;
    std::uint64_t checks = 0;
  };

  /// Begins the next search.
  void begin_part() {
    if (groups_.empty()) {
      if (division_.given) groups_.push_back({members_along(*division_.given), *division_.given, {}});
      for (const std::size_t i : division_.order) groups_.push_back({{i}, {}, {}});
      if (division_.how != Coordination::order) {
        std::sort(groups_.begin(), groups_.end(), [](const Group& a, const Group& b) { return a.robots < b.robots; });
      }
      if (division_.given) {
        blocking_.clear();
        find_blocking(0);
        groups_.front().blocking = blocking_;
      }
    }
    const auto next = std::find_if(groups_.begin(), groups_.end(), [](const Group& group) { return !group.path; });
    std::vector<RobotsPath> along;
    if (next == groups_.end()) {
      for (const Group& group : groups_) along.push_back(*group.path);
      begin_search(std::move(along), {}, "coordination", nullptr);
      return;
    }
    // The path of a robot in order is that of all robots up to it.
    if (division_.how == Coordination::order) {
      blocking_ = next == groups_.begin() ? std::set<std::size_t>() : std::prev(next)->blocking;
      const auto place = static_cast<std::size_t>(next - groups_.begin());
      waiting_ = waits_ ? waiting_beside(place) : std::vector<std::size_t>();
      waits_ = !waiting_.empty();
      if (auto path = with_waiting(place, waiting_)) along.push_back(std::move(*path));
    }
    begin_search(std::move(along), next->robots, name_of(members_, next->robots), guide_for(next->robots.size()));
  }

  /// The members that a path moves.
  [[nodiscard]] std::vector<std::size_t> members_along(const RobotsPath& path) const {
    std::vector<std::size_t> along;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (std::binary_search(path.axes().begin(), path.axes().end(), members_[i].axes.front())) along.push_back(i);
    }
    return along;
  }

  /// The guide of a search of so many robots; nullptr: none that applies.
  [[nodiscard]] const GuideSpec* guide_for(std::size_t robots) const {
    return guide_ != nullptr && guides_searches_of(*guide_, robots) ? guide_ : nullptr;
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
        if (std::binary_search(moving.begin(), moving.end(), axis)) q[j] = context_.instance.goals[goal()][axis];
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

  /// Pays here for the checks of an instance.
  void count(const Instance& part) { count_checks(part, context_.instance); }

  /// The goal of this try: the robots of one search must go to the same one as those of another.
  [[nodiscard]] std::size_t goal() const {
    return static_cast<std::size_t>(division_.tries - tries_left_) % context_.instance.goals.size();
  }

  void begin_search(std::vector<RobotsPath> along, const std::vector<std::size_t>& robots, const std::string& name,
                    const GuideSpec* guide) {
    Instance& instance = context_.instance;
    space_ = std::make_shared<TeamSpace>(instance, std::move(along), axes_of(members_, robots), name);
    auto part = space_->project(instance);
    if (certifies_) part->validity = std::make_shared<CertifiedValidity>(part->validity, exact_tolerance_of(*part));
    if (part->goals.size() > 1) {
      part->goals.assign(1, Configuration(part->space.dimension()));
      space_->project(instance.goals[goal()], part->goals.front());
      for (std::size_t g = 0; g < space_->along().size(); ++g) part->goals.front()[g] = space_->along()[g].length();
    }
    // The level of a robot has the same key in all runs; a further search of it another number.
    const std::size_t number = robots.empty()       ? members_.size()
                               : robots.size() == 1 ? robots.front()
                                                    : members_.size() + 1 + joined_++;
    levels_.push_back(std::make_unique<Level>(run_, &level_,
                                              fmt::format("{}/{}.{}", level_.record().key, searches_[number]++, number),
                                              name, std::move(part), planner_, space_));
    current_ = levels_.back().get();
    if (guide != nullptr) current_->guide_by(*guide);
  }

  /// Takes a path that a search found, of the axes of its space.
  /// \param all  whether these are those of the team
  void take(Configurations path, bool all) {
    const auto next = std::find_if(groups_.begin(), groups_.end(), [](const Group& group) { return !group.path; });
    if (next != groups_.end() && next->robots.size() > 1) {
      note_joined(next->robots, levels_.back()->instance().checks.validity);
    }
    if (next == groups_.end() || (all && waiting_.empty())) {
      found_ = std::move(path);
      note_path();
      return;
    }
    if (waiting_.empty()) {
      next->path.emplace(context_.instance.space, space_->axes(), std::move(path));
      if (division_.how == Coordination::order) find_blocking(static_cast<std::size_t>(next - groups_.begin()));
    } else {
      next->path.emplace(context_.instance.space, without_waiting(space_->axes()), without_waiting(path));
    }
    next->blocking = blocking_;
    waits_ = true;
  }

  /// What remains of the axes of the last search, and of its path, without the robots that wait.
  [[nodiscard]] std::vector<std::size_t> without_waiting(const std::vector<std::size_t>& axes) const {
    const std::vector<std::size_t> parked = axes_of(members_, waiting_);
    std::vector<std::size_t> left;
    std::set_difference(axes.begin(), axes.end(), parked.begin(), parked.end(), std::back_inserter(left));
    return left;
  }
  [[nodiscard]] Configurations without_waiting(const Configurations& path) const {
    const std::vector<std::size_t> left = without_waiting(space_->axes());
    Configurations moving(left.size());
    Configuration q(left.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
      for (std::size_t j = 0, k = 0; j < space_->axes().size(); ++j) {
        if (k < left.size() && space_->axes()[j] == left[k]) q[k++] = path[i][j];
      }
      moving.push(q);
    }
    return moving;
  }

  /// Begins to prune a path of the robots of the last search: later searches follow it, and each motion of theirs has a
  /// piece for each of its configurations.
  void begin_pruning(const Configurations& path, const std::vector<std::size_t>& axes) {
    Instance& team = context_.instance;
    if (axes.size() < team.space.dimension()) placed_ = TeamSpace(team, {}, axes, "placed").project(team);
    const Instance& instance = placed_ ? *placed_ : team;
    const auto certified = std::make_shared<CertifiedValidity>(instance.validity, coarse_tolerance_of(instance));
    pruning_.emplace(path, [&team, certified](View a, View b) {
      const MotionReport report = certified->motion(a, b);
      team.checks.validity += report.checks;
      ++team.checks.motion;
      return report.valid;
    });
  }

  /// Continues to prune; takes the path once it is done.
  std::optional<Status> prune() {
    constexpr std::uint64_t piece = 256;
    const std::uint64_t before = context_.instance.checks.validity;
    while (!pruning_->done() && context_.instance.checks.validity < before + piece) pruning_->step();
    if (!pruning_->done()) return std::nullopt;
    const Configurations path = pruning_->path();
    pruning_.reset();
    const bool all = placed_ == nullptr;
    placed_.reset();
    take(path, all);
    return found_ ? std::optional(Status::solved) : std::nullopt;
  }

  /// Adds the path found to the nodes of this search.
  void note_path() {
    for (std::size_t i = 1; i < found_->size(); ++i) {
      context_.search.parents.push_back(i == 1 ? 0 : static_cast<std::uint32_t>(context_.search.nodes.size() - 1));
      context_.search.nodes.push(std::as_const(*found_)[i]);
    }
  }

  [[nodiscard]] bool all_found() const {
    return std::all_of(groups_.begin(), groups_.end(), [](const Group& group) { return group.path.has_value(); });
  }

  /// The last search found no path: changes the order or the groups, or begins anew.
  void fail() {
    if (!waiting_.empty()) {
      // Again, without those that wait.
      waits_ = false;
      return;
    }
    --tries_left_;
    waits_ = true;
    const auto next = std::find_if(groups_.begin(), groups_.end(), [](const Group& group) { return !group.path; });
    switch (division_.how) {
      case Coordination::order: {
        // What a robot cannot do alone, it cannot do among others.
        const std::ptrdiff_t given = division_.given ? 1 : 0;
        if (next - groups_.begin() == given) {
          tries_left_ = 0;
          return;
        }
        if (!division_.of_window) {
          TeamConflict& conflict = run_.conflicts.emplace_back();
          conflict.robots = numbers_of(next->robots);
          conflict.resolved = TeamConflict::Resolved::order;
          conflict.checks = levels_.back()->instance().checks.validity;
        }
        // It plans earlier: the paths of the robots that are still before it remain.
        // With several goals another try has another one, to which those paths do not lead.
        const auto kept = std::max(given, context_.instance.goals.size() > 1 ? 0 : (next - groups_.begin()) / 2);
        const auto earlier = groups_.begin() + kept;
        std::rotate(earlier, next, std::next(next));
        for (auto group = earlier; group != groups_.end(); ++group) group->path.reset();
        return;
      }
      case Coordination::alone:
      case Coordination::conflicts:
      case Coordination::windows:
        // Other paths may be passed.
        if (next != groups_.end() && next->robots.size() == 1) tries_left_ = 0;
        groups_.clear();
        passing_.clear();
        all_scheduled_ = false;
        return;
    }
  }

  /// Begins to search when groups move along their paths: of each two, and then of all.
  /// \return false where a path is missing, or all these searches have ended
  bool begin_timetable() {
    if (groups_.empty() || !all_found()) return false;
    for (std::size_t k = 1; k < groups_.size(); ++k) {
      for (std::size_t i = 0; i < k; ++i) {
        if (!passing_.insert({groups_[i].robots, groups_[k].robots}).second) continue;
        timetable_ = std::make_unique<Timetable>(context_.instance, groups_, std::vector{i, k});
        return true;
      }
    }
    // One group has no other to wait for, two have been examined together.
    if (std::exchange(all_scheduled_, true)) return false;
    std::vector<std::size_t> all(groups_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    timetable_ = std::make_unique<Timetable>(context_.instance, groups_, std::move(all));
    return true;
  }

  /// Continues to search when groups move.
  std::optional<Status> schedule() {
    Timetable& of = *timetable_;
    constexpr std::uint64_t piece = 256;
    const bool all = of.groups.size() == groups_.size();
    const bool pair = of.groups.size() == 2;
    // A pair has few places: all are examined.
    const auto most = pair ? std::numeric_limits<std::size_t>::max() : static_cast<std::size_t>(division_.effort);
    std::optional<Configurations> found;
    while (!found && !of.search.exhausted() && of.search.expanded() < most && of.paths->checks.validity < piece) {
      found = of.search.expand();
    }
    count(*of.paths);
    of.checks += of.paths->checks.validity;
    of.paths->checks = {};
    if (!found && !of.search.exhausted() && of.search.expanded() < most) return std::nullopt;
    const auto ended = std::exchange(timetable_, nullptr);
    if (pair) note_pair(*ended, found);
    if (found && all) {
      begin_pruning(ended->space.placed(*found), ended->space.axes());
      return std::nullopt;
    }
    if (found || !pair) return std::nullopt;
    // They cannot pass each other.
    if (division_.how == Coordination::conflicts) {
      join(ended->groups[0], ended->groups[1]);
    } else {
      fail();
    }
    return std::nullopt;
  }

  [[nodiscard]] std::vector<std::size_t> numbers_of(const std::vector<std::size_t>& robots) const {
    std::vector<std::size_t> numbers;
    numbers.reserve(robots.size());
    for (const std::size_t i : robots) numbers.push_back(members_[i].number);
    return numbers;
  }

  /// Records whether two groups conflict that move along their paths, both in equal shares of theirs, and whether they
  /// can wait for each other.
  void note_pair(const Timetable& ended, const std::optional<Configurations>& found) {
    if (found && found->size() <= Timetable::cells + 1) return;
    const std::vector<std::size_t>& first = groups_[ended.groups[0]].robots;
    const std::vector<std::size_t>& second = groups_[ended.groups[1]].robots;
    TeamConflict& conflict = run_.conflicts.emplace_back();
    conflict.robots = numbers_of(first);
    for (const std::size_t number : numbers_of(second)) conflict.robots.push_back(number);
    std::sort(conflict.robots.begin(), conflict.robots.end());
    // Of groups of several it is not known which robots touch.
    if (conflict.robots.size() == 2) conflict.touching = {conflict.robots};
    if (found) conflict.resolved = TeamConflict::Resolved::schedule;
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

  void join(std::size_t first, std::size_t second) {
    std::vector<std::size_t>& robots = groups_[first].robots;
    all_scheduled_ = false;
    robots.insert(robots.end(), groups_[second].robots.begin(), groups_[second].robots.end());
    std::sort(robots.begin(), robots.end());
    groups_[first].path.reset();
    std::erase_if(passing_, [&](const auto& pair) {
      const auto overlaps = [&](const auto& group) {
        return std::any_of(group.begin(), group.end(),
                           [&](std::size_t i) { return std::binary_search(robots.begin(), robots.end(), i); });
      };
      return overlaps(pair.first) || overlaps(pair.second);
    });
    groups_.erase(groups_.begin() + static_cast<std::ptrdiff_t>(second));
  }

  Run& run_;
  Level& level_;
  PlannerSpec planner_;
  const GuideSpec* guide_;
  TeamDivision division_;
  std::vector<TeamMember> members_;
  std::vector<std::unique_ptr<Level>> levels_;  ///< of all searches; their records are taken after the run
  Level* current_ = nullptr;                    ///< the search that has not ended
  std::shared_ptr<TeamSpace> space_;            ///< of the last search
  std::vector<Group> groups_;                   ///< of this try; empty before it begins
  bool waits_ = true;                           ///< in order: the next search first tries beside robots that wait
  std::vector<std::size_t> waiting_;            ///< in order: robots that wait at their starts, of the last search
  std::set<std::size_t> blocking_;              ///< in order: robots that cannot wait at their starts any more
  std::set<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> passing_;  ///< pairs that were examined
  std::map<std::size_t, std::size_t> searches_;  ///< so far, by the number of their robots
  std::unique_ptr<Timetable> timetable_;         ///< the search of when to move that has not ended
  bool all_scheduled_ = false;                   ///< that of all groups has ended
  std::size_t joined_ = 0;                       ///< groups of several robots that were searched
  std::int64_t tries_left_;
  bool certifies_ = false;  ///< the search certifies each of its motions: the one before found a path that touches
  std::optional<PathPruning> pruning_;  ///< of a path that is not pruned yet
  std::unique_ptr<Instance> placed_;    ///< of the robots of that path; nullptr: of all
  std::optional<Configurations> found_;
};

}  // namespace

bool guides_searches_of(const GuideSpec& guide, std::size_t robots) {
  if (guide.kind() != GuideSpec::Kind::component) {
    return std::all_of(guide.terms().begin(), guide.terms().end(),
                       [&](const GuideSpec::Term& term) { return guides_searches_of(term.guide, robots); });
  }
  if (guide.custom()) return robots == 1;
  switch (find_guide(guide.name())->claims.needs) {
    case GuideClaims::Needs::team: return robots > 1;
    case GuideClaims::Needs::position:
    case GuideClaims::Needs::position_axes: return robots == 1;
    default: return true;
  }
}

std::unique_ptr<Planner> make_team_search(Run& run, Level& level, const PlannerSpec& planner, const GuideSpec* guide,
                                          const TeamDivision& division, PlannerContext context) {
  return std::make_unique<TeamSearch>(run, level, planner, guide, division, std::move(context));
}

}  // namespace trellis
