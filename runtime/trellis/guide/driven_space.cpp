// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/driven_space.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/guide/along_space.hpp>
#include <trellis/guide/team.hpp>

namespace trellis {

/// Where a configuration of the space places its robots.
class DrivenSpace::Placement {
 public:
  Placement(const Instance& team, std::vector<DrivenPath> along, std::vector<std::size_t> robots,
            const std::string& name)
      : along_(std::move(along)), robots_(std::move(robots)), start_(team.start), team_(team.space) {
    const TeamModel& model = *team_model(*team.motion_model);
    model_holder_ = team.motion_model;
    controls_ = model.controls().size();
    dt_ = model.dt();
    const std::vector<TeamMember> members = team.scene->members();
    all_ = robots_;
    for (const DrivenPath& path : along_) all_.insert(all_.end(), path.robots.begin(), path.robots.end());
    std::sort(all_.begin(), all_.end());
    placed_ = axes_of(members, all_);
    // The state of those that follow no motion: all configurations, then all velocities.
    own_ = axes_of(members, robots_);
    std::vector<std::shared_ptr<const MotionModel>> models;
    std::vector<std::vector<std::size_t>> axes;
    std::size_t first = along_.size();
    std::vector<double> lengths;
    constexpr double share = 0.04;  // of the diameter of the other coordinates: to be near means to be near in these
    double widest = 1.0;
    for (const std::size_t r : robots_) {
      const TeamModel::Part& part = model.parts()[r];
      for (std::size_t j = members[r].axes.size(); j < part.columns.size(); ++j) own_.push_back(part.columns[j]);
    }
    const Space own = team.space.part(own_, name);
    if (!robots_.empty()) widest = share * own.diameter();
    for (std::size_t g = 0; g < along_.size(); ++g) {
      const double duration = dt_ * static_cast<double>(along_[g].steps());
      models.push_back(std::make_shared<const PathClock>(duration, dt_));
      axes.push_back({g});
      lengths.push_back(duration + 0.5 * dt_);
    }
    for (const std::size_t r : robots_) {
      models.push_back(model.parts()[r].model);
      std::vector<std::size_t> columns(members[r].axes.size());
      std::iota(columns.begin(), columns.end(), first);
      first += columns.size();
      axes.push_back(std::move(columns));
    }
    motion_ = models.size() == 1 ? models.front() : std::make_shared<const TeamModel>(models, axes);
    space_ = space_along(lengths, widest, own, name);
  }

  [[nodiscard]] const std::vector<DrivenPath>& along() const { return along_; }
  [[nodiscard]] const std::vector<std::size_t>& robots() const { return robots_; }
  /// The robots that it places, ascending.
  [[nodiscard]] const std::vector<std::size_t>& all() const { return all_; }
  /// The coordinates of their configurations among those of the team, ascending.
  [[nodiscard]] const std::vector<std::size_t>& placed() const { return placed_; }
  /// The coordinates of the team that are those of S after the clocks.
  [[nodiscard]] const std::vector<std::size_t>& own() const { return own_; }
  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] const Space& team() const { return team_; }
  [[nodiscard]] const std::shared_ptr<const MotionModel>& motion() const { return motion_; }
  [[nodiscard]] double dt() const { return dt_; }
  [[nodiscard]] std::size_t controls() const { return controls_; }

  /// The number of steps that robots along a motion have taken.
  [[nodiscard]] std::size_t step_of(std::size_t g, double seconds) const {
    const double step = std::round(seconds / dt_);
    return static_cast<std::size_t>(std::clamp(step, 0.0, static_cast<double>(along_[g].steps())));
  }
  /// Writes the states of robots along a motion after so many steps into a state of the team.
  void overlay(std::size_t g, std::size_t step, MutableView q) const {
    const View there = along_[g].states[step];
    for (const std::size_t r : along_[g].robots) {
      for (const std::size_t column : team_model(*model_holder_)->parts()[r].columns) q[column] = there[column];
    }
  }
  /// Writes a state of the team.
  /// \param steps  of each motion
  void place_team(const std::vector<std::size_t>& steps, View own, MutableView q) const {
    std::copy(start_.begin(), start_.end(), q.begin());
    for (std::size_t g = 0; g < along_.size(); ++g) overlay(g, steps[g], q);
    for (std::size_t j = 0; j < own_.size(); ++j) q[own_[j]] = own[j];
  }
  void place_team(View s, MutableView q) const {
    std::vector<std::size_t> steps(along_.size());
    for (std::size_t g = 0; g < steps.size(); ++g) steps[g] = step_of(g, s[g]);
    place_team(steps, s.subspan(along_.size()), q);
  }
  /// Writes the configuration of the robots that it places.
  void place(View s, MutableView q) const {
    Configuration whole(team_.dimension());
    place_team(s, whole);
    pick(whole, q);
  }
  /// Calls `f(steps, own)` for the states of a motion of S after each step, in turn, until it returns false; its first
  /// argument is how far it is, from 0 to 1.
  /// \return false where robots would go back
  template <class F>
  bool each_step(View a, View b, const F& f) const {
    std::vector<std::size_t> from(along_.size()), to(along_.size());
    std::size_t most = 1;
    for (std::size_t g = 0; g < along_.size(); ++g) {
      from[g] = step_of(g, a[g]);
      to[g] = step_of(g, b[g]);
      if (to[g] < from[g]) return false;
      most = std::max(most, to[g] - from[g]);
    }
    Configuration s(space_.dimension());
    for (std::size_t k = 1; k <= most; ++k) {
      std::vector<std::size_t> steps(along_.size());
      for (std::size_t g = 0; g < steps.size(); ++g) steps[g] = std::min(from[g] + k, to[g]);
      const double share = static_cast<double>(k) / static_cast<double>(most);
      space_.interpolate(a, b, share, s);
      if (!f(share, steps, View(s).subspan(along_.size()))) break;
    }
    return true;
  }
  [[nodiscard]] std::size_t places() const { return placed_.size(); }
  [[nodiscard]] bool keeps(View s) const { return space_.contains(s) && motion_->admits(s); }
  /// Calls `f(before, after)` with `from` and `to`, of `placed`, at the ends of each step, until it returns false.
  /// \return false where robots would go back
  template <class F>
  bool each_piece(View a, View b, Configuration& from, Configuration& to, const F& f) const {
    place(a, from);
    Configuration whole(team_.dimension());
    double before = 0.0;
    return each_step(a, b, [&](double after, const std::vector<std::size_t>& steps, View own) {
      place_team(steps, own, whole);
      pick(whole, to);
      if (!f(before, after)) return false;
      before = after;
      std::swap(from, to);
      return true;
    });
  }
  /// The controls of the team in one step.
  /// \param before, after  steps of each motion
  /// \param u  of S; empty: the robots of S that follow no motion wait
  void control(const std::vector<std::size_t>& before, const std::vector<std::size_t>& after, View u,
               MutableView out) const {
    const TeamModel& model = *team_model(*model_holder_);
    std::fill(out.begin(), out.end(), 0.0);
    for (std::size_t g = 0; g < along_.size(); ++g) {
      if (after[g] == before[g]) continue;
      const View whole = along_[g].controls[before[g]];
      for (const std::size_t r : along_[g].robots) {
        const TeamModel::Part& part = model.parts()[r];
        const View own = part.own(whole);
        std::copy(own.begin(), own.end(), out.begin() + static_cast<std::ptrdiff_t>(part.control));
      }
    }
    if (u.empty()) return;
    std::size_t at = along_.size();
    for (const std::size_t r : robots_) {
      const TeamModel::Part& part = model.parts()[r];
      const View own = u.subspan(at, part.model->controls().size());
      std::copy(own.begin(), own.end(), out.begin() + static_cast<std::ptrdiff_t>(part.control));
      at += own.size();
    }
  }

 private:
  void pick(View whole, MutableView q) const {
    for (std::size_t j = 0; j < placed_.size(); ++j) q[j] = whole[placed_[j]];
  }

  std::vector<DrivenPath> along_;
  std::vector<std::size_t> robots_;
  Configuration start_;  ///< of the team
  Space team_;
  std::shared_ptr<const MotionModel> model_holder_;  ///< of the team
  std::vector<std::size_t> all_;
  std::vector<std::size_t> placed_;
  std::vector<std::size_t> own_;
  std::shared_ptr<const MotionModel> motion_;
  Space space_;
  double dt_ = 0.0;
  std::size_t controls_ = 0;
};

DrivenSpace::DrivenSpace(const Instance& parent, std::vector<DrivenPath> along, std::vector<std::size_t> robots,
                         const std::string& name)
    : placement_(std::make_shared<const Placement>(parent, std::move(along), std::move(robots), name)) {}

std::unique_ptr<Instance> DrivenSpace::project(const Instance& parent) {
  const Placement& placement = *placement_;
  const std::vector<TeamMember> members = parent.scene->members();
  const bool all = placement.all().size() == members.size();
  const auto scene = all ? parent.scene : parent.scene->reduced(placement.placed());
  auto instance = std::make_unique<Instance>();
  instance->space = placement.space();
  instance->motion_model = placement.motion();
  instance->validity = std::make_shared<AlongValidity<Placement>>(
      placement_, make_validity(parent.collision, scene, placement.team().part(placement.placed(), "robots"),
                                parent.resolution, nullptr));
  instance->scene = placement.robots().empty() ? scene : parent.scene->reduced(axes_of(members, placement.robots()));
  std::vector<double> ends;
  for (const DrivenPath& path : placement.along()) ends.push_back(placement.dt() * static_cast<double>(path.steps()));
  complete_along(*this, parent, ends, *instance);
  // The distances of all robots together are within the tolerance of the team where each one's is.
  instance->goal_tolerance = parent.goal_tolerance / std::sqrt(static_cast<double>(members.size()));
  return instance;
}

void DrivenSpace::project(View q, MutableView s) const {
  const Placement& placement = *placement_;
  for (std::size_t g = 0; g < placement.along().size(); ++g) {
    const DrivenPath& path = placement.along()[g];
    double least = std::numeric_limits<double>::infinity();
    s[g] = 0.0;
    Configuration there(q.begin(), q.end());
    for (std::size_t i = 0; i < path.states.size(); ++i) {
      placement.overlay(g, i, there);
      const double squared = placement.team().squared_distance(there, q);
      if (squared >= least) continue;
      least = squared;
      s[g] = placement.dt() * static_cast<double>(i);
    }
  }
  for (std::size_t j = 0; j < placement.own().size(); ++j) s[placement.along().size() + j] = q[placement.own()[j]];
}

void DrivenSpace::lift(View s, Stream& stream, MutableView q) const {
  const Placement& placement = *placement_;
  placement.team().sample_uniform(stream, q);
  for (std::size_t g = 0; g < placement.along().size(); ++g) placement.overlay(g, placement.step_of(g, s[g]), q);
  for (std::size_t j = 0; j < placement.own().size(); ++j) q[placement.own()[j]] = s[placement.along().size() + j];
}

double DrivenSpace::log_fibre_density(View q) const {
  return placement_->team().contains(q) ? placement_->space().log_volume() - placement_->team().log_volume()
                                        : -std::numeric_limits<double>::infinity();
}

bool DrivenSpace::closed_fibre() const { return placement_->along().empty(); }

std::unique_ptr<Heuristic> DrivenSpace::heuristic(Instance&, const Instance*, const Solution*) {
  throw Fault("the space of some robots guides by the path of the whole team");
}

std::size_t DrivenSpace::clocks() const { return placement_->along().size(); }

DrivenPath DrivenSpace::driven(const Solution& found) const {
  const Placement& placement = *placement_;
  DrivenPath motion{placement.all(), Configurations(placement.team().dimension()),
                    Configurations(placement.controls())};
  Configuration q(placement.team().dimension());
  Configuration u(placement.controls());
  // The control of each motion of the path.
  std::vector<std::uint32_t> rows;
  for (std::uint32_t row = 0; row < found.trajectory.steps.size(); ++row) {
    rows.insert(rows.end(), found.trajectory.steps[row], row);
  }
  std::vector<std::size_t> steps(placement.along().size(), 0);
  placement.place_team(found.path[0], q);
  motion.states.push(q);
  for (std::size_t g = 0; g < steps.size(); ++g) steps[g] = placement.step_of(g, found.path[0][g]);
  for (std::size_t i = 1; i < found.path.size(); ++i) {
    const View own_control = rows.empty() ? View() : View(found.trajectory.controls[rows[i - 1]]);
    placement.each_step(found.path[i - 1], found.path[i], [&](double, const std::vector<std::size_t>& after, View own) {
      placement.place_team(after, own, q);
      placement.control(steps, after, own_control, u);
      motion.states.push(q);
      motion.controls.push(u);
      steps = after;
      return true;
    });
  }
  return motion;
}

}  // namespace trellis
