// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/driven_team_search.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <trellis/guide/driven_space.hpp>
#include <trellis/guide/schedule.hpp>
#include <trellis/instance/certified_validity.hpp>
#include <trellis/planner/loop.hpp>
#include <trellis/strategy/team_parts.hpp>
#include <trellis/strategy/team_search.hpp>

namespace trellis {

namespace {

class DrivenTeamSearch final : public Planner {
 public:
  DrivenTeamSearch(Run& run, Level& level, PlannerSpec planner, const GuideSpec* guide, TeamDivision division,
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
      begin_anew();
      tries_left_ = division_.tries;
    }
    if (instance.to_goal(instance.start) > instance.goal_tolerance) return std::nullopt;
    found_.emplace();
    found_->states = path_of_start(instance);
    found_->controls = Configurations(instance.motion_model->controls().size());
    return Status::solved;
  }

  [[nodiscard]] bool draws() const override { return false; }

  std::optional<Status> step() override {
    if (timetable_) return schedule();
    if (current_ == nullptr) {
      if (tries_left_ <= 0) return Status::budget_spent;
      if (division_.how != Coordination::order && all_found()) {
        begin_timetable();
        return std::nullopt;
      }
      begin_part();
    }
    constexpr double piece = 256.0;
    const Advance advance = current_->advance(static_cast<double>(division_.effort), {Budget::unlimited, piece});
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
    const std::optional<Solution> whole = completed(ended);
    if (!whole) {
      fail();
      return std::nullopt;
    }
    // What touches another robot between two checked configurations leads nowhere: again, and then each motion is
    // certified.
    if (!certifies_ && !certified(ended.instance(), whole->path)) {
      certifies_ = true;
      return std::nullopt;
    }
    certifies_ = false;
    take(space_->driven(*whole));
    return found_ ? std::optional(Status::solved) : std::nullopt;
  }

  [[nodiscard]] Solution solution(Status status) override {
    const Instance& instance = context_.instance;
    if (status != Status::solved || !found_) return {status, path_of_start(instance), {}};
    Solution solution{
        status, found_->states, {Configurations(found_->controls.dimension()), {}, instance.motion_model->dt()}};
    Trajectory& trajectory = solution.trajectory;
    const Configurations& controls = found_->controls;
    for (std::size_t i = 0; i < controls.size(); ++i) {
      const bool same = i > 0 && std::ranges::equal(controls[i], controls[i - 1]);
      if (!same) {
        trajectory.controls.push(controls[i]);
        trajectory.steps.push_back(0);
      }
      ++trajectory.steps.back();
    }
    return solution;
  }

 private:
  /// Robots that plan together.
  struct Group {
    std::vector<std::size_t> robots;  ///< members, ascending
    std::optional<DrivenPath> path;   ///< once found; in order, of all robots up to it
  };

  /// The search of when some groups move.
  struct Timetable {
    Timetable(const Instance& team, const std::vector<Group>& all, std::vector<std::size_t> some)
        : groups(std::move(some)),
          space(team, paths_of(all, groups), {}, "schedule"),
          paths(space.project(team)),
          search(*paths, cells) {}

    static constexpr std::size_t cells = 16;
    static std::vector<DrivenPath> paths_of(const std::vector<Group>& all, const std::vector<std::size_t>& some) {
      std::vector<DrivenPath> along;
      along.reserve(some.size());
      for (const std::size_t g : some) along.push_back(*all[g].path);
      return along;
    }

    std::vector<std::size_t> groups;
    DrivenSpace space;
    std::unique_ptr<Instance> paths;
    ScheduleSearch search;
  };

  void begin_anew() {
    groups_.clear();
    passing_.clear();
    all_scheduled_ = false;
    certifies_ = false;
  }

  /// The goal of this try: the robots of one search must go to the same one as those of another.
  [[nodiscard]] const Configuration& goal() const {
    const Instance& instance = context_.instance;
    return instance.goals[static_cast<std::size_t>(division_.tries - tries_left_) % instance.goals.size()];
  }

  [[nodiscard]] bool all_found() const {
    return !groups_.empty() &&
           std::all_of(groups_.begin(), groups_.end(), [](const Group& group) { return group.path.has_value(); });
  }

  /// Begins the search of the next group.
  void begin_part() {
    Instance& instance = context_.instance;
    if (groups_.empty()) {
      for (const std::size_t i : division_.order) groups_.push_back({{i}, {}});
      if (division_.how != Coordination::order) {
        std::sort(groups_.begin(), groups_.end(), [](const Group& a, const Group& b) { return a.robots < b.robots; });
      }
    }
    const auto next = std::find_if(groups_.begin(), groups_.end(), [](const Group& group) { return !group.path; });
    std::vector<DrivenPath> along;
    if (division_.how == Coordination::order && next != groups_.begin()) along.push_back(*std::prev(next)->path);
    const std::vector<std::size_t>& robots = next->robots;
    const std::string name = name_of(members_, robots);
    space_ = std::make_shared<DrivenSpace>(instance, std::move(along), robots, name);
    auto part = space_->project(instance);
    const Configuration ends = part->goals.front();
    part->goals.assign(1, Configuration(part->space.dimension()));
    space_->project(goal(), part->goals.front());
    for (std::size_t g = 0; g < space_->clocks(); ++g) part->goals.front()[g] = ends[g];
    if (certifies_) part->validity = std::make_shared<CertifiedValidity>(part->validity, exact_tolerance_of(*part));
    // The level of a robot has the same key in all runs; a further search of it another number.
    const std::size_t number = robots.size() == 1 ? robots.front() : members_.size() + 1 + joined_++;
    levels_.push_back(std::make_unique<Level>(run_, &level_,
                                              fmt::format("{}/{}.{}", level_.record().key, searches_[number]++, number),
                                              name, std::move(part), planner_, space_));
    current_ = levels_.back().get();
    if (guide_ != nullptr && guides_searches_of(*guide_, robots.size())) current_->guide_by(*guide_);
  }

  /// The path that a search found, with the robots before it driven to the ends of their motions, if that is valid.
  [[nodiscard]] std::optional<Solution> completed(Level& ended) {
    Solution whole = ended.solution();
    Instance& part = ended.instance();
    if (space_->clocks() == 0) return whole;
    const View end = part.goal();
    Configuration control(part.motion_model->controls().size(), 0.0);
    for (std::size_t g = 0; g < space_->clocks(); ++g) control[g] = 1.0;
    Configuration at(whole.path.back().begin(), whole.path.back().end());
    double left = 0.0;
    for (std::size_t g = 0; g < space_->clocks(); ++g) left = std::max(left, end[g] - at[g]);
    const auto steps = static_cast<std::uint32_t>(std::max(0.0, std::round(left / part.motion_model->dt())));
    if (steps == 0) return whole;
    Configurations states(part.space.dimension());
    const std::uint32_t done = part.drive(at, control, steps, states);
    if (done < steps) return std::nullopt;
    for (std::size_t i = 0; i < states.size(); ++i) whole.path.push(std::as_const(states)[i]);
    whole.trajectory.controls.push(control);
    whole.trajectory.steps.push_back(steps);
    return whole;
  }

  /// Takes a motion that a search found.
  void take(DrivenPath path) {
    if (path.robots.size() == members_.size()) {
      finish(std::move(path));
      return;
    }
    std::find_if(groups_.begin(), groups_.end(), [](const Group& group) { return !group.path; })->path =
        std::move(path);
  }

  /// The motion of the whole team is found: adds it to the nodes of this search.
  void finish(DrivenPath path) {
    found_ = std::move(path);
    for (std::size_t i = 1; i < found_->states.size(); ++i) {
      context_.search.parents.push_back(i == 1 ? 0 : static_cast<std::uint32_t>(context_.search.nodes.size() - 1));
      context_.search.nodes.push(std::as_const(found_->states)[i]);
    }
  }

  /// The last search found no path: changes the order, or begins anew.
  void fail() {
    --tries_left_;
    const auto next = std::find_if(groups_.begin(), groups_.end(), [](const Group& group) { return !group.path; });
    if (division_.how != Coordination::order) {
      // Other paths may be passed.
      if (next != groups_.end() && next->robots.size() == 1) tries_left_ = 0;
      begin_anew();
      return;
    }
    // What a robot cannot do alone, it cannot do among others.
    if (next == groups_.begin()) {
      tries_left_ = 0;
      return;
    }
    // It plans earlier: the paths of the robots that are still before it remain. With several goals another try has
    // another one, to which those paths do not lead.
    const auto kept = context_.instance.goals.size() > 1 ? 0 : (next - groups_.begin()) / 2;
    const auto earlier = groups_.begin() + kept;
    std::rotate(earlier, next, std::next(next));
    for (auto group = earlier; group != groups_.end(); ++group) group->path.reset();
  }

  /// Begins to search when groups move along their motions: of each two, and then of all.
  void begin_timetable() {
    for (std::size_t k = 1; k < groups_.size(); ++k) {
      for (std::size_t i = 0; i < k; ++i) {
        if (!passing_.insert({groups_[i].robots, groups_[k].robots}).second) continue;
        timetable_ = std::make_unique<Timetable>(context_.instance, groups_, std::vector{i, k});
        return;
      }
    }
    if (std::exchange(all_scheduled_, true)) {
      fail();
      return;
    }
    std::vector<std::size_t> all(groups_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    timetable_ = std::make_unique<Timetable>(context_.instance, groups_, std::move(all));
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
    count_checks(*of.paths, context_.instance);
    of.paths->checks = {};
    if (!found && !of.search.exhausted() && of.search.expanded() < most) return std::nullopt;
    const auto ended = std::exchange(timetable_, nullptr);
    if (found && all) {
      if (!certified(*ended->paths, *found)) {
        count_checks(*ended->paths, context_.instance);
        fail();
        return std::nullopt;
      }
      count_checks(*ended->paths, context_.instance);
      finish(ended->space.driven({Status::solved, *found, {}}));
      return Status::solved;
    }
    if (found) return std::nullopt;
    // They cannot pass each other.
    if (pair && division_.how == Coordination::conflicts) {
      join(ended->groups[0], ended->groups[1]);
    } else {
      fail();
    }
    return std::nullopt;
  }

  void join(std::size_t first, std::size_t second) {
    std::vector<std::size_t>& robots = groups_[first].robots;
    all_scheduled_ = false;
    robots.insert(robots.end(), groups_[second].robots.begin(), groups_[second].robots.end());
    std::sort(robots.begin(), robots.end());
    groups_[first].path.reset();
    groups_.erase(groups_.begin() + static_cast<std::ptrdiff_t>(second));
    passing_.clear();
  }

  Run& run_;
  Level& level_;
  PlannerSpec planner_;
  const GuideSpec* guide_;
  TeamDivision division_;
  std::vector<TeamMember> members_;
  std::vector<std::unique_ptr<Level>> levels_;  ///< of all searches; their records are taken after the run
  Level* current_ = nullptr;                    ///< the search that has not ended
  std::shared_ptr<DrivenSpace> space_;          ///< of the last search
  std::vector<Group> groups_;                   ///< of this try; empty before it begins
  std::set<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> passing_;  ///< pairs that were examined
  std::map<std::size_t, std::size_t> searches_;  ///< so far, by the number of their robots
  std::unique_ptr<Timetable> timetable_;         ///< the search of when to move that has not ended
  bool all_scheduled_ = false;                   ///< that of all groups has ended
  std::size_t joined_ = 0;                       ///< groups of several robots that were searched
  std::int64_t tries_left_;
  bool certifies_ = false;  ///< the search certifies each of its motions: the one before found a path that touches
  std::optional<DrivenPath> found_;
};

}  // namespace

std::unique_ptr<Planner> make_driven_team_search(Run& run, Level& level, const PlannerSpec& planner,
                                                 const GuideSpec* guide, const TeamDivision& division,
                                                 PlannerContext context) {
  return std::make_unique<DrivenTeamSearch>(run, level, planner, guide, division, std::move(context));
}

}  // namespace trellis
