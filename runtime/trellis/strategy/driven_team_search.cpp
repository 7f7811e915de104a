// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/guide/driven_space.hpp>
#include <trellis/strategy/team_groups.hpp>

namespace trellis {

namespace {

/// The groups of a team that is driven by motion models.
class DrivenTeamSearch final : public GroupsSearch<DrivenSpace, RobotGroup<DrivenPath>> {
 public:
  using GroupsSearch::GroupsSearch;

  [[nodiscard]] Solution solution(Status status) override {
    Solution solution = GroupsSearch::solution(status);
    if (status != Status::solved || !found_) return solution;
    Trajectory& trajectory = solution.trajectory;
    trajectory = {Configurations(controls_.dimension()), {}, context_.instance.motion_model->dt()};
    const Configurations& controls = controls_;
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
  void begin_anew() override {
    GroupsSearch::begin_anew();
    controls_.clear();
  }

  void begin_part() override {
    if (groups_.empty()) add_groups();
    const auto next = next_group();
    std::vector<DrivenPath> along;
    if (division_.how == Coordination::order && next != groups_.begin()) along.push_back(*std::prev(next)->path);
    space_ = std::make_shared<DrivenSpace>(context_.instance, std::move(along), next->robots, name_of(next->robots));
    begin_search(part_of(*space_, space_->clocks()), space_, next->robots);
    guide_part(next->robots.size());
  }

  std::optional<Status> end_part(Level& ended) override {
    const std::optional<Solution> whole = completed(ended);
    if (!whole) {
      fail();
      return std::nullopt;
    }
    if (!accepts(ended, whole->path)) return std::nullopt;
    DrivenPath path = space_->driven(*whole);
    if (path.robots.size() == members_.size()) return keep(std::move(path));
    next_group()->path = std::move(path);
    return std::nullopt;
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

  /// Takes the motion of the whole team.
  Status keep(DrivenPath path) {
    controls_ = std::move(path.controls);
    finish(std::move(path.states));
    return Status::solved;
  }

  std::optional<Status> schedule() override {
    const auto ended = advance_timetable();
    if (!ended) return std::nullopt;
    if (!ended->found) {
      separate(*ended);
      passing_.clear();
    } else if (ended->groups.size() == groups_.size()) {
      const bool valid = certified(*ended->paths, *ended->found);
      count(*ended->paths);
      if (valid) return keep(ended->space.driven({Status::solved, *ended->found, {}}));
      fail();
    }
    return std::nullopt;
  }

  Configurations controls_{context_.instance.motion_model->controls().size()};  ///< of each step of the path found
};

}  // namespace

std::unique_ptr<Planner> make_driven_team_search(TeamSearchContext context) {
  return std::make_unique<DrivenTeamSearch>(std::move(context));
}

}  // namespace trellis
